// SPDX-License-Identifier: BSD-3-Clause
#include "cli/field/child_process.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <deque>
#include <fstream>
#include <system_error>
#include <utility>

#include "bus/process/process.hpp"

namespace orchard::cli {
namespace {

constexpr std::chrono::seconds kLongLife{10};
constexpr std::chrono::milliseconds kFirstWait{200};
constexpr std::chrono::milliseconds kWaitMax{5000};

/// Runs in the child between fork and exec; calls only async-signal-safe functions.
[[noreturn]] void become(const std::vector<char*>& arguments, int log) {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  setpgid(0, 0);  // Ctrl-C reaches only the parent, which stops the children in order
  prctl(PR_SET_PDEATHSIG, SIGTERM);  // if the parent is killed, the child stops
  if (log >= 0) {
    dup2(log, STDOUT_FILENO);
    dup2(log, STDERR_FILENO);
  }
  execv(arguments.front(), arguments.data());
  _exit(127);
}

}  // namespace

ChildProcess::ChildProcess(ChildPlan plan) : plan_(std::move(plan)) {}

ChildProcess::~ChildProcess() {
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  if (pidfd_ >= 0) close(pidfd_);
}

void ChildProcess::start(const std::vector<std::string>& more) {
  plan_.arguments.insert(plan_.arguments.end(), more.begin(), more.end());
  std::vector<char*> arguments;
  for (std::string& word : plan_.arguments) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const int log = plan_.log_path.empty() ? -1
                                         : ::open(plan_.log_path.c_str(),
                                                  O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  const pid_t pid = fork();
  if (pid == 0) become(arguments, log);
  const int error = errno;
  if (log >= 0) close(log);
  if (pid < 0) throw std::system_error(error, std::generic_category(), "starting " + plan_.name);
  pid_ = pid;
  pidfd_ = static_cast<int>(syscall(SYS_pidfd_open, pid, 0));
  exit_code_.reset();
  started_ = Clock::now();
  restart_at_ = Clock::time_point::max();
}

std::optional<std::string> ChildProcess::watch() {
  if (pid_ > 0) {
    int status = 0;
    if (waitpid(pid_, &status, WNOHANG) != pid_) return std::nullopt;
    return take_end(status);
  }
  if (stopping_ || Clock::now() < restart_at_) return std::nullopt;
  start();
  ++num_restarts_;
  return plan_.name + " was restarted (" + std::to_string(num_restarts_) + ")";
}

std::string ChildProcess::take_end(int status) {
  pid_ = -1;
  if (pidfd_ >= 0) close(pidfd_);
  pidfd_ = -1;
  exit_code_ = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  std::string text = plan_.name;
  if (WIFSIGNALED(status)) {
    text += std::string(" was killed by signal ") + strsignal(WTERMSIG(status));
  } else if (*exit_code_ == 127) {
    text += ": " + plan_.arguments.front() + " cannot be started; install it beside orchard";
  } else {
    text += " ended with exit code " + std::to_string(*exit_code_);
  }
  const bool is_mistake = *exit_code_ == bus::kExitUsage || *exit_code_ == bus::kExitInput ||
                          *exit_code_ == 127;  // a restart would fail in the same way
  if (stopping_ || *exit_code_ == bus::kExitOk || is_mistake) return text;
  if (Clock::now() - started_ > kLongLife) wait_ = std::chrono::milliseconds(0);
  restart_at_ = Clock::now() + wait_;
  wait_ = std::min(std::max(2 * wait_, kFirstWait), kWaitMax);
  return text;
}

void ChildProcess::ask_to_stop() {
  stopping_ = true;
  if (pid_ > 0) kill(pid_, SIGINT);
}

void ChildProcess::kill_now() {
  stopping_ = true;
  if (pid_ > 0) kill(pid_, SIGKILL);
}

std::string last_lines(const std::string& path, int num_lines) {
  std::ifstream file(path);
  std::deque<std::string> lines;
  for (std::string line; std::getline(file, line);) {
    lines.push_back(line);
    if (static_cast<int>(lines.size()) > num_lines) lines.pop_front();
  }
  std::string text;
  for (const std::string& line : lines) text += "    " + line + "\n";
  return text;
}

}  // namespace orchard::cli
