// SPDX-License-Identifier: BSD-3-Clause
#include "cli/interruptible_work.hpp"

#include <csignal>
#include <utility>

namespace orchard::cli {
namespace {

volatile std::sig_atomic_t interrupted = 0;  // a type that a signal handler may write

void note_signal(int) { interrupted = 1; }

void handle_stop_signals(void (*handler)(int)) {
  for (const int signal : {SIGINT, SIGTERM}) {
    struct sigaction action {};
    sigaction(signal, nullptr, &action);
    if (action.sa_handler == SIG_IGN) continue;  // keep a signal ignored if the parent ignores it
    action.sa_handler = handler;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigemptyset(&action.sa_mask);
    sigaction(signal, &action, nullptr);
  }
}

}  // namespace

InterruptibleWork::InterruptibleWork(std::string label, bool show_progress)
    : bar_(std::move(label), show_progress), on_broken_pipe_(std::signal(SIGPIPE, SIG_IGN)) {
  handle_stop_signals(note_signal);
}

InterruptibleWork::~InterruptibleWork() {
  handle_stop_signals(SIG_DFL);
  std::signal(SIGPIPE, on_broken_pipe_);
}

void InterruptibleWork::update(std::uint64_t done, std::uint64_t total) {
  if (interrupted != 0) throw Interrupted();
  bar_.update(done, total);
}

}  // namespace orchard::cli
