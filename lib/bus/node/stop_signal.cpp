// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/stop_signal.hpp"

#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace orchard::bus {
namespace {

bool is_ignored(int signal) {
  struct sigaction action {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

/// Includes a closed terminal and a broken pipe: they end the process, but only after its last
/// save. If they are ignored (nohup, systemd's IgnoreSIGPIPE), the process continues.
sigset_t stop_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  for (const int signal : {SIGHUP, SIGPIPE}) {
    if (!is_ignored(signal)) sigaddset(&set, signal);
  }
  return set;
}

}  // namespace

StopSignal::StopSignal() {
  const sigset_t set = stop_signals();
  if (const int error = pthread_sigmask(SIG_BLOCK, &set, nullptr)) {
    throw std::system_error(error, std::generic_category(), "blocking SIGINT and SIGTERM");
  }
  fileno_ = signalfd(-1, &set, SFD_NONBLOCK | SFD_CLOEXEC);
  if (fileno_ < 0) throw std::system_error(errno, std::generic_category(), "signalfd");
}

StopSignal::~StopSignal() {
  close(fileno_);
  // A further signal (each line written to a broken pipe raises one) must not end the process with
  // another exit code.
  if (raised_) {
    for (const int stopping : {SIGHUP, SIGPIPE}) signal(stopping, SIG_IGN);
  }
  const sigset_t set = stop_signals();
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

bool StopSignal::raised() {
  signalfd_siginfo signal{};
  if (!raised_ && read(fileno_, &signal, sizeof(signal)) == sizeof(signal)) raised_ = true;
  return raised_;
}

bool StopSignal::wait(int other, int timeout_ms) {
  pollfd waiting[2] = {{other, POLLIN, 0}, {fileno_, POLLIN, 0}};
  if (poll(waiting, 2, timeout_ms) <= 0) return false;
  return (waiting[0].revents & (POLLIN | POLLERR | POLLHUP)) != 0;
}

}  // namespace orchard::bus
