// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::bus {

/// Tells a supervisor that speaks systemd's notification protocol (sd_notify(3)) how the process
/// is: one datagram to the socket that NOTIFY_SOCKET names. Without that variable it does nothing.
class ServiceNotifier {
 public:
  ServiceNotifier();
  ~ServiceNotifier();
  ServiceNotifier(const ServiceNotifier&) = delete;
  ServiceNotifier& operator=(const ServiceNotifier&) = delete;

  /// The process has begun its work.
  void ready();

  /// It is alive, called from its loop: feeds the watchdog. `text` is shown by systemctl status.
  void alive(const std::string& text);

 private:
  void send(const std::string& state);
  int fileno_ = -1;
  std::string said_;
};

}  // namespace orchard::bus
