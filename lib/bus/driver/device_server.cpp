// SPDX-License-Identifier: BSD-3-Clause
#include "bus/driver/device_server.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "bus/node/process_report.hpp"
#include "text/parse_number.hpp"

namespace orchard::bus {
namespace {

/// Max bytes buffered for a client that does not read; more is lost, as with a real device.
constexpr std::size_t kLineHolds_bytes = 64 * 1024;

/// A terminal that nobody has open reports a hang-up to every poll, so it is checked at this
/// interval instead.
constexpr std::chrono::milliseconds kObservation{10};

[[noreturn]] void throw_errno(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

}  // namespace

DeviceServer::DeviceServer(std::unique_ptr<device::EmulatedDevice> device, const std::string& where)
    : device_(std::move(device)), start_utime_(wall_utime()), start_(Clock::now()) {
  const std::size_t colon = where.rfind(':');
  if (where.rfind("tcp:", 0) == 0 && colon > 4) {
    is_tcp_ = true;
    host_ = where.substr(4, colon - 4);
    port_ = parse_number<int>(std::string_view(where).substr(colon + 1)).value_or(-1);
    if (port_ < 0 || port_ > 65535) {
      throw std::invalid_argument(where + ": the port must be 0 to 65535");
    }
  } else if (where.rfind("pty:", 0) == 0) {
    link_ = where.substr(4);
  } else {
    throw std::invalid_argument(where + ": must be tcp:HOST:PORT or pty:LINK");
  }
  plug_in();
}

DeviceServer::~DeviceServer() { unplug(); }

std::int64_t DeviceServer::now() const {
  return start_utime_ +
         std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - start_).count();
}

void DeviceServer::plug_in() {
  if (listener_ >= 0 || line_ >= 0) return;
  if (is_tcp_) {
    listen();
  } else {
    open_terminal();
  }
}

void DeviceServer::unplug() {
  drop_client();
  if (listener_ >= 0) ::close(std::exchange(listener_, -1));
  if (line_ >= 0) ::close(std::exchange(line_, -1));
  if (!is_tcp_ && !link_.empty()) ::unlink(link_.c_str());
}

void DeviceServer::replace(std::unique_ptr<device::EmulatedDevice> device) {
  device_ = std::move(device);
  if (has_client()) device_->connected(now());
}

void DeviceServer::listen() {
  listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int on = 1;
  setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port_));
  if (inet_pton(AF_INET, host_.c_str(), &address.sin_addr) != 1) {
    throw std::invalid_argument(host_ + ": must be a numeric address such as 127.0.0.1");
  }
  socklen_t size = sizeof(address);
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  if (listener_ < 0 || bind(listener_, generic, size) != 0 || ::listen(listener_, 4) != 0 ||
      getsockname(listener_, generic, &size) != 0) {
    throw_errno("tcp:" + host_ + ":" + std::to_string(port_));
  }
  port_ = ntohs(address.sin_port);
  address_ = "tcp:" + host_ + ":" + std::to_string(port_);
}

void DeviceServer::open_terminal() {
  line_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  std::array<char, 128> path{};
  if (line_ < 0 || grantpt(line_) != 0 || unlockpt(line_) != 0 ||
      ptsname_r(line_, path.data(), path.size()) != 0) {
    throw_errno("a pseudo terminal");
  }
  termios settings{};
  if (tcgetattr(line_, &settings) == 0) {
    cfmakeraw(&settings);  // otherwise early output is echoed back to us as commands
    tcsetattr(line_, TCSANOW, &settings);
  }
  // Open and close it once: afterwards it reports a hang-up while nobody has it open.
  const int other = ::open(path.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (other >= 0) ::close(other);
  is_hung_up_ = true;
  if (link_.empty()) {
    address_ = std::string("serial:") + path.data();
    return;
  }
  ::unlink(link_.c_str());
  if (::symlink(path.data(), link_.c_str()) != 0) throw_errno(link_);
  address_ = "serial:" + link_;
}

std::vector<pollfd> DeviceServer::files() {
  std::vector<pollfd> files;
  if (listener_ >= 0) files.push_back({listener_, POLLIN, 0});
  if (has_client()) {
    files.push_back({line_, static_cast<short>(POLLIN | (unsent_.empty() ? 0 : POLLOUT)), 0});
  }
  return files;
}

DeviceServer::Clock::time_point DeviceServer::deadline() {
  Clock::time_point due = Clock::time_point::max();
  if (const auto utime = device_->deadline()) {
    due = start_ + std::chrono::microseconds(*utime - start_utime_);
  }
  return !is_tcp_ && line_ >= 0 && is_hung_up_ ? std::min(due, Clock::now() + kObservation) : due;
}

void DeviceServer::step() {
  if (listener_ >= 0) accept_client();
  if (!is_tcp_ && line_ >= 0) watch_terminal();
  if (has_client()) read_line();
  device_->advance(now());
  const std::string bytes = device_->take_to_send();
  if (!has_client()) return;
  if (unsent_.size() + bytes.size() <= kLineHolds_bytes) unsent_ += bytes;
  write_line();
}

void DeviceServer::accept_client() {
  const int client = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (client < 0) return;
  drop_client();  // the newest client wins: the older one may be gone
  const int on = 1;
  setsockopt(client, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
  line_ = client;
  is_hung_up_ = false;
  device_->connected(now());
}

void DeviceServer::watch_terminal() {
  pollfd state{line_, 0, 0};
  const bool hung_up = ::poll(&state, 1, 0) > 0 && (state.revents & POLLHUP) != 0;
  if (is_hung_up_ && !hung_up) device_->connected(now());
  if (hung_up) unsent_.clear();
  is_hung_up_ = hung_up;
}

void DeviceServer::read_line() {
  std::array<char, 4096> bytes{};
  const ssize_t count = ::read(line_, bytes.data(), bytes.size());
  if (count > 0) {
    device_->receive({bytes.data(), static_cast<std::size_t>(count)}, now());
  } else if (is_tcp_ && (count == 0 || (errno != EAGAIN && errno != EINTR))) {
    drop_client();
  }
}

void DeviceServer::write_line() {
  if (unsent_.empty()) return;
  const ssize_t count = is_tcp_ ? ::send(line_, unsent_.data(), unsent_.size(), MSG_NOSIGNAL)
                                : ::write(line_, unsent_.data(), unsent_.size());
  if (count > 0) {
    unsent_.erase(0, static_cast<std::size_t>(count));
  } else if (is_tcp_ && errno != EAGAIN && errno != EINTR) {
    drop_client();
  }
}

void DeviceServer::drop_client() {
  unsent_.clear();
  if (!is_tcp_ || line_ < 0) return;
  ::close(std::exchange(line_, -1));
  is_hung_up_ = true;
}

}  // namespace orchard::bus
