// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/process_report.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "bus/node/process_options.hpp"

namespace orchard::bus {
namespace {

/// Minimum intervals between two messages, so that other processes cannot trigger a flood.
constexpr std::chrono::milliseconds kStatusApart{100};
constexpr std::chrono::seconds kConfigApart{1};
constexpr std::chrono::seconds kConfigPeriod{10};

}  // namespace

std::string machine_name() {
  char name[256] = {};
  return gethostname(name, sizeof(name) - 1) == 0 ? name : "unknown";
}

std::string machine_of(const std::string& host) { return host.substr(0, host.rfind(':')); }

ServiceNotifier::ServiceNotifier() {
  const char* path = std::getenv("NOTIFY_SOCKET");
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path == nullptr || (path[0] != '/' && path[0] != '@') ||
      std::strlen(path) >= sizeof(address.sun_path)) {
    return;
  }
  std::memcpy(address.sun_path, path, std::strlen(path));
  if (path[0] == '@') address.sun_path[0] = '\0';  // Linux abstract socket name
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + std::strlen(path));
  fileno_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fileno_ >= 0 && connect(fileno_, reinterpret_cast<sockaddr*>(&address), size) != 0) {
    close(fileno_);
    fileno_ = -1;
  }
}

ServiceNotifier::~ServiceNotifier() {
  if (fileno_ >= 0) close(fileno_);
}

void ServiceNotifier::ready() { send("READY=1\n"); }

void ServiceNotifier::alive(const std::string& text) {
  std::string state = "WATCHDOG=1\n";
  if (text != said_) {
    std::string line = text;
    std::replace(line.begin(), line.end(), '\n', ' ');
    state += "STATUS=" + line + "\n";
    said_ = text;
  }
  send(state);
}

void ServiceNotifier::send(const std::string& state) {
  // Non-blocking: if the supervisor does not read, the next notification follows in a second.
  if (fileno_ >= 0) (void)::send(fileno_, state.data(), state.size(), MSG_NOSIGNAL);
}

std::int64_t wall_utime() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

ProcessReport::ProcessReport(Bus& bus, std::string name, const io::EffectiveConfig& config)
    : bus_(bus), name_(std::move(name)), host_(machine_name() + ":" + std::to_string(getpid())) {
  notice_.hash = config.hash;
  notice_.name = name_;
  notice_.version = std::string(version());
  notice_.text = config.text;
  next_status_ = next_config_ = last_status_ = Clock::now();
  supervisor_.ready();
}

void ProcessReport::note_input(double latency_s) {
  ++num_inputs_;
  latency_sum_s_ += latency_s;
  latency_max_s_ = std::max(latency_max_s_, latency_s);
}

void ProcessReport::send_soon(bool with_config) {
  next_status_ = std::min(next_status_, last_status_ + kStatusApart);
  if (!with_config) return;
  const Clock::time_point last_config = next_config_ - kConfigPeriod;
  next_config_ = std::min(next_config_, last_config + kConfigApart);
  next_status_ = std::min(next_status_, std::max(next_config_, last_status_ + kStatusApart));
}

int ProcessReport::ms_until_due() const {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(next_status_ - Clock::now());
  return static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, 1000));
}

void ProcessReport::send(Status status) {
  const Clock::time_point now = Clock::now();
  status.utime = wall_utime();
  status.seq = status_seq_++;
  status.name = name_;
  status.host = host_;
  if (num_inputs_ > 0) {
    const double elapsed_s = std::chrono::duration<double>(now - last_status_).count();
    status.input_period_s = elapsed_s / static_cast<double>(num_inputs_);
    status.latency_mean_s = latency_sum_s_ / static_cast<double>(num_inputs_);
    status.latency_max_s = latency_max_s_;
  }
  if (!error_.empty()) {
    status.level = Level::kError;
    status.text = error_ + (status.text.empty() ? "" : "; " + status.text);
  }
  bus_.publish(Channel::kStatus, encode(status));
  supervisor_.alive(status.text);
  num_inputs_ = 0;
  latency_sum_s_ = latency_max_s_ = 0.0;
  last_status_ = now;
  next_status_ += std::chrono::seconds(1);
  if (next_status_ < now) next_status_ = now + std::chrono::seconds(1);
  if (!notice_.text.empty() && now >= next_config_) {
    notice_.utime = wall_utime();
    bus_.publish(Channel::kConfig, encode(notice_));
    ++notice_.seq;
    next_config_ = now + kConfigPeriod;
  }
}

}  // namespace orchard::bus
