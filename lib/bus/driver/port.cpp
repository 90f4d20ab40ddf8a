// SPDX-License-Identifier: BSD-3-Clause
#include "bus/driver/port.hpp"
#include "text/parse_number.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <utility>

namespace orchard::bus {
namespace {

/// Pause between two attempts to open. With up to a second for the connection itself, a device that
/// is back is read within two seconds.
constexpr std::chrono::milliseconds kRetryPeriod{500};

/// Timeout of a TCP connection attempt.
constexpr std::chrono::milliseconds kConnectWait{1000};

constexpr std::size_t kReadMax_bytes = 64 * 1024;

/// Max bytes buffered for a device that does not read; commands are a few dozen bytes.
constexpr std::size_t kUnsentMax_bytes = 64 * 1024;

/// derived: a second of a scanner's packets, for a host that is held up.
constexpr int kDatagramsHeld_bytes = 2 * 1024 * 1024;

constexpr std::pair<int, speed_t> kBauds[] = {
    {4800, B4800},     {9600, B9600},     {19200, B19200},   {38400, B38400},   {57600, B57600},
    {115200, B115200}, {230400, B230400}, {460800, B460800}, {500000, B500000}, {921600, B921600},
};

std::optional<speed_t> speed_of(int baud) {
  for (const auto& [number, speed] : kBauds) {
    if (number == baud) return speed;
  }
  return std::nullopt;
}

[[noreturn]] void refuse(const std::string& text, const std::string& why) {
  throw std::invalid_argument("\"" + text + "\": " + why +
                              "; write tcp:192.168.0.10:10940, serial:/dev/ttyACM0, "
                              "serial:/dev/ttyUSB0:115200, udp:2368 or udp:192.168.1.201:2368");
}

PortAddress parse_tcp(const std::string& text, const std::string& rest) {
  const std::size_t colon = rest.rfind(':');
  if (colon == std::string::npos || colon == 0) refuse(text, "needs a host and a port");
  PortAddress address;
  address.kind = PortAddress::Kind::kTcp;
  address.host = rest.substr(0, colon);
  if (address.host.size() > 1 && address.host.front() == '[' && address.host.back() == ']') {
    address.host = address.host.substr(1, address.host.size() - 2);
  }
  address.service = rest.substr(colon + 1);
  const std::optional<int> number = parse_number<int>(address.service);
  if (!number || *number < 1 || *number > 65535) refuse(text, "its port must be 1 to 65535");
  return address;
}

PortAddress parse_udp(const std::string& text, const std::string& rest) {
  const std::size_t colon = rest.rfind(':');
  PortAddress address;
  address.kind = PortAddress::Kind::kUdp;
  if (colon != std::string::npos) address.host = rest.substr(0, colon);
  address.service = colon == std::string::npos ? rest : rest.substr(colon + 1);
  in_addr numbers{};
  if (colon != std::string::npos && inet_pton(AF_INET, address.host.c_str(), &numbers) != 1) {
    refuse(text, "the sender must be an address of four numbers");
  }
  const std::optional<int> number = parse_number<int>(address.service);
  if (!number || *number < 1 || *number > 65535) refuse(text, "its port must be 1 to 65535");
  return address;
}

PortAddress parse_serial(const std::string& text, const std::string& rest) {
  PortAddress address;
  const std::size_t colon = rest.rfind(':');
  address.path = rest.substr(0, colon);
  if (address.path.empty() || address.path.front() != '/') refuse(text, "needs a device file");
  if (colon == std::string::npos) return address;
  const std::optional<int> baud = parse_number<int>(rest.substr(colon + 1));
  if (!baud || !speed_of(*baud)) refuse(text, "its baud rate is not supported");
  address.baud = *baud;
  return address;
}

addrinfo* resolve(const PortAddress& address) {
  addrinfo hints{};
  hints.ai_family = address.host == "localhost" ? AF_INET : AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICSERV | (address.host == "localhost" ? 0 : AI_NUMERICHOST);
  addrinfo* found = nullptr;
  const std::string host = address.host == "localhost" ? "127.0.0.1" : address.host;
  return getaddrinfo(host.c_str(), address.service.c_str(), &hints, &found) == 0 ? found : nullptr;
}

/// Configures raw bytes, no echo, no flow control and exclusive use. Returns false and sets errno
/// on failure.
bool set_up_terminal(int fileno, int baud) {
  termios settings{};
  if (tcgetattr(fileno, &settings) != 0) return false;
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB);
  settings.c_cc[VMIN] = 0;
  settings.c_cc[VTIME] = 0;
  const speed_t speed = speed_of(baud).value_or(B115200);
  cfsetispeed(&settings, speed);
  cfsetospeed(&settings, speed);
  if (tcsetattr(fileno, TCSANOW, &settings) != 0) return false;
  ioctl(fileno, TIOCEXCL);  // rejects a second driver of the device, if the system supports it
  tcflush(fileno, TCIOFLUSH);
  return true;
}

std::string open_problem(const std::string& name, int error) {
  std::string text = "cannot open " + name + ": " + std::strerror(error);
  if (error == EACCES) text += " (add the user to group dialout)";
  if (error == EADDRINUSE) text += " (another program receives on this port: stop it)";
  if (error == ENOENT) text += " (check that it is plugged in)";
  return text;
}

}  // namespace

PortAddress parse_port(const std::string& text) {
  if (text.rfind("tcp:", 0) == 0) return parse_tcp(text, text.substr(4));
  if (text.rfind("udp:", 0) == 0) return parse_udp(text, text.substr(4));
  if (text.rfind("serial:", 0) == 0) return parse_serial(text, text.substr(7));
  if (text.rfind('/', 0) == 0) return parse_serial(text, text);
  refuse(text, "must begin with tcp:, udp: or serial:");
}

Port::Port(PortAddress address) : address_(std::move(address)) {}

Port::~Port() {
  if (fileno_ >= 0) ::close(fileno_);
}

std::string Port::name() const {
  if (address_.kind == PortAddress::Kind::kSerial) return "serial:" + address_.path;
  if (address_.kind == PortAddress::Kind::kTcp)
    return "tcp:" + address_.host + ":" + address_.service;
  return "udp:" + address_.host + (address_.host.empty() ? "" : ":") + address_.service;
}

bool Port::poll_connection() {
  if (state_ == State::kConnecting) return finish_tcp();
  if (state_ == State::kOpen || Clock::now() < next_attempt_) return false;
  if (address_.kind == PortAddress::Kind::kSerial) {
    open_serial();
  } else if (address_.kind == PortAddress::Kind::kUdp) {
    open_udp();
  } else {
    begin_tcp();
    if (state_ == State::kConnecting) return finish_tcp();
  }
  return state_ == State::kOpen;
}

void Port::open_serial() {
  fileno_ = ::open(address_.path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fileno_ < 0) return close(open_problem(name(), errno));
  if (!set_up_terminal(fileno_, address_.baud)) {
    return close(name() + " is not a serial line: " + std::strerror(errno));
  }
  state_ = State::kOpen;
  problem_.clear();
}

void Port::begin_tcp() {
  addrinfo* found = resolve(address_);
  if (found == nullptr) {
    return close("\"" + address_.host + "\" is not a numeric address such as 192.168.0.10");
  }
  fileno_ = socket(found->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int result =
      fileno_ < 0 ? -1
                  : ::connect(fileno_, found->ai_addr, static_cast<socklen_t>(found->ai_addrlen));
  const int error = errno;
  freeaddrinfo(found);
  if (fileno_ < 0 || (result != 0 && error != EINPROGRESS)) {
    return close(open_problem(name(), error));
  }
  state_ = State::kConnecting;
  next_attempt_ = Clock::now() + kConnectWait;
}

bool Port::finish_tcp() {
  pollfd waiting{fileno_, POLLOUT, 0};
  if (poll(&waiting, 1, 0) <= 0) {
    if (Clock::now() >= next_attempt_)
      close("cannot open " + name() + ": no answer; check address, power and cable");
    return false;
  }
  int error = 0;
  socklen_t size = sizeof(error);
  getsockopt(fileno_, SOL_SOCKET, SO_ERROR, &error, &size);
  if (error != 0) {
    close(open_problem(name(), error));
    return false;
  }
  const int on = 1;  // commands are small and must be sent at once
  setsockopt(fileno_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
  state_ = State::kOpen;
  problem_.clear();
  return true;
}

void Port::open_udp() {
  fileno_ = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  sockaddr_in here{};
  here.sin_family = AF_INET;
  here.sin_port =
      htons(static_cast<std::uint16_t>(parse_number<int>(address_.service).value_or(0)));
  here.sin_addr.s_addr = htonl(INADDR_ANY);
  if (fileno_ < 0 || bind(fileno_, reinterpret_cast<const sockaddr*>(&here), sizeof(here)) != 0) {
    return close(open_problem(name(), errno));
  }
  setsockopt(fileno_, SOL_SOCKET, SO_RCVBUF, &kDatagramsHeld_bytes, sizeof(int));
  state_ = State::kOpen;
  problem_.clear();
}

/// Strangers are few, or there would be no end of them: after some it is the next call's turn.
void Port::read_datagram(std::string& bytes) {
  constexpr int kMaxStrangers = 100;
  std::array<char, kReadMax_bytes> datagram;
  for (int i = 0; i < kMaxStrangers; ++i) {
    sockaddr_in from{};
    socklen_t size = sizeof(from);
    const ssize_t count = ::recvfrom(fileno_, datagram.data(), datagram.size(), 0,
                                     reinterpret_cast<sockaddr*>(&from), &size);
    if (count < 0) {
      if (errno != EAGAIN && errno != EINTR) close(name() + ": " + std::strerror(errno));
      return;
    }
    std::array<char, INET_ADDRSTRLEN> sender{};
    in_addr wanted{};
    inet_pton(AF_INET, address_.host.c_str(), &wanted);
    if (address_.host.empty() || wanted.s_addr == from.sin_addr.s_addr) {
      bytes.append(datagram.data(), static_cast<std::size_t>(count));
      return;
    }
    stranger_ = inet_ntop(AF_INET, &from.sin_addr, sender.data(), sender.size());
  }
}

void Port::read_into(std::string& bytes) {
  if (state_ != State::kOpen) return;
  if (address_.kind == PortAddress::Kind::kUdp) return read_datagram(bytes);
  const std::size_t before = bytes.size();
  bytes.resize(before + kReadMax_bytes);
  const ssize_t count = ::read(fileno_, bytes.data() + before, kReadMax_bytes);
  const int error = errno;
  bytes.resize(before + static_cast<std::size_t>(count > 0 ? count : 0));
  if (count > 0) return;
  if (count == 0) {
    // A serial line without data also reads 0 bytes; only a removed one reports a hang-up.
    pollfd state{fileno_, 0, 0};
    const bool hung_up = poll(&state, 1, 0) > 0 && (state.revents & (POLLHUP | POLLERR)) != 0;
    if (address_.kind == PortAddress::Kind::kTcp || hung_up)
      close(name() + ": the device closed the connection");
  } else if (error != EAGAIN && error != EINTR) {
    close(name() + ": " + std::strerror(error));
  }
}

void Port::write(std::string_view bytes) {
  if (state_ != State::kOpen || address_.kind == PortAddress::Kind::kUdp) return;
  unsent_ += bytes;
  if (unsent_.empty()) return;
  const ssize_t count = address_.kind == PortAddress::Kind::kTcp
                            ? ::send(fileno_, unsent_.data(), unsent_.size(), MSG_NOSIGNAL)
                            : ::write(fileno_, unsent_.data(), unsent_.size());
  if (count > 0) unsent_.erase(0, static_cast<std::size_t>(count));
  if (count < 0 && errno != EAGAIN && errno != EINTR)
    return close(name() + ": " + std::strerror(errno));
  if (unsent_.size() > kUnsentMax_bytes) close(name() + ": the device does not accept commands");
}

void Port::close(const std::string& reason) {
  if (fileno_ >= 0) ::close(fileno_);
  fileno_ = -1;
  state_ = State::kClosed;
  unsent_.clear();
  problem_ = reason;
  next_attempt_ = Clock::now() + kRetryPeriod;
}

}  // namespace orchard::bus
