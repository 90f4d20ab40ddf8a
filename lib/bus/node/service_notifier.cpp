// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/service_notifier.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace orchard::bus {

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

}  // namespace orchard::bus
