// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::bus {

/// Reports the process state to a supervisor by systemd's notification protocol (sd_notify(3)): one
/// datagram to the socket named by NOTIFY_SOCKET. Does nothing when that variable is not set.
class ServiceNotifier {
 public:
  ServiceNotifier();
  ~ServiceNotifier();
  ServiceNotifier(const ServiceNotifier&) = delete;
  ServiceNotifier& operator=(const ServiceNotifier&) = delete;

  /// Reports READY: initialization is complete.
  void ready();

  /// Feeds the watchdog; call it from the process's loop. `text` is shown by systemctl status.
  void alive(const std::string& text);

 private:
  void send(const std::string& state);
  int fileno_ = -1;
  std::string said_;
};

}  // namespace orchard::bus
