// SPDX-License-Identifier: BSD-3-Clause
#include "cli/farm/farm_command.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <system_error>

#include "cli/command_line.hpp"

namespace orchard::cli {
namespace {

int open_for_writing(const std::string& path) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0666);
  if (fd < 0) throw std::system_error(errno, std::generic_category(), path);
  return fd;
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// While it exists, the end of a child and the signals that stop are waited for instead of handled;
/// a signal that the caller ignores (nohup) stays ignored.
class WaitedSignals {
 public:
  WaitedSignals() {
    sigemptyset(&set_);
    sigaddset(&set_, SIGCHLD);
    for (const int stop : {SIGINT, SIGTERM}) {
      struct sigaction action {};
      sigaction(stop, nullptr, &action);
      if (action.sa_handler != SIG_IGN) sigaddset(&set_, stop);
    }
    pthread_sigmask(SIG_BLOCK, &set_, &before_);
  }
  ~WaitedSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  WaitedSignals(const WaitedSignals&) = delete;
  WaitedSignals& operator=(const WaitedSignals&) = delete;

  /// The next signal; -1 after half a second without one.
  int wait() const {
    const timespec half_second{0, 500'000'000};
    return sigtimedwait(&set_, nullptr, &half_second);
  }

  /// In the child: signals as a program expects them.
  void restore() const {
    for (const int stop : {SIGINT, SIGTERM}) signal(stop, SIG_DFL);
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }

 private:
  sigset_t set_{}, before_{};
};

/// Becomes the program, in a process group of its own. Own words need that this process has one
/// thread; else only calls that are safe between fork and exec.
[[noreturn]] void become(const FarmCommand& command, char** argv, int out, int err,
                         const WaitedSignals& signals) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  signals.restore();
  dup2(out, STDOUT_FILENO);
  dup2(err, STDERR_FILENO);
  if (!command.folder.empty() && chdir(command.folder.c_str()) != 0) _exit(127);
  if (command.is_own) std::exit(run_command_line(static_cast<int>(command.words.size()), argv));
  execvp(argv[0], argv);
  _exit(127);
}

}  // namespace

CommandResult run_command(const FarmCommand& command) {
  std::vector<std::string> words = command.words;
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const int out = open_for_writing(command.stdout_path);
  const int err =
      command.stderr_path == command.stdout_path ? out : open_for_writing(command.stderr_path);
  const WaitedSignals signals;
  const auto start = std::chrono::steady_clock::now();
  std::fflush(nullptr);  // what is buffered is written once
  const pid_t pid = fork();
  if (pid == 0) become(command, argv.data(), out, err, signals);
  const int error = errno;
  close(out);
  if (err != out) close(err);
  if (pid < 0) throw std::system_error(error, std::generic_category(), "starting " + words.front());
  setpgid(pid, pid);  // here, too: a signal may come before the child has done it
  CommandResult end;
  int status = 0;
  rusage usage{};
  while (wait4(pid, &status, WNOHANG, &usage) == 0) {
    const int signal = signals.wait();
    // As SIGINT, at which Snakemake cancels the jobs of a cluster.
    if (signal == SIGINT || signal == SIGTERM) {
      kill(-pid, SIGINT);
      end.is_stopped = true;
    }
    if (command.while_running) command.while_running();
  }
  end.exit_code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  end.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  end.processor_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  end.memory_mb = static_cast<double>(usage.ru_maxrss) / 1024.0;
  return end;
}

}  // namespace orchard::cli
