// SPDX-License-Identifier: BSD-3-Clause
#include "cli/farm/command_run.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <system_error>

namespace orchard::cli {
namespace {

constexpr int kLookEvery_ms = 500;

int open_for_writing(const std::string& path) {
  if (path.empty()) return -1;
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (fd < 0) throw std::system_error(errno, std::generic_category(), path);
  return fd;
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// Ignores SIGINT in this process: Ctrl-C reaches the whole process group, so the command ends by
/// itself, and this process after it.
class IgnoredInterrupt {
 public:
  IgnoredInterrupt() {
    struct sigaction ignore {};
    ignore.sa_handler = SIG_IGN;
    sigaction(SIGINT, &ignore, &before_);
  }
  ~IgnoredInterrupt() { sigaction(SIGINT, &before_, nullptr); }
  IgnoredInterrupt(const IgnoredInterrupt&) = delete;
  IgnoredInterrupt& operator=(const IgnoredInterrupt&) = delete;
  const struct sigaction& before() const { return before_; }

 private:
  struct sigaction before_ {};
};

}  // namespace

CommandResult run_command(const std::vector<std::string>& arguments, const std::string& output_path,
                          const std::string& stdout_path, const std::string& in_folder,
                          const std::function<void()>& while_running) {
  std::vector<std::string> words = arguments;
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const int output = open_for_writing(output_path);
  const int standard = stdout_path.empty() ? -1 : open_for_writing(stdout_path);
  const IgnoredInterrupt ignored;
  const auto start = std::chrono::steady_clock::now();
  const pid_t pid = fork();
  if (pid == 0) {  // only calls that are safe between fork and exec
    sigaction(SIGINT, &ignored.before(), nullptr);
    if (output >= 0) dup2(output, STDOUT_FILENO), dup2(output, STDERR_FILENO);
    if (standard >= 0) dup2(standard, STDOUT_FILENO);
    if (!in_folder.empty() && chdir(in_folder.c_str()) != 0) _exit(127);
    execvp(argv.front(), argv.data());
    _exit(127);
  }
  const int error = errno;
  if (output >= 0) close(output);
  if (standard >= 0) close(standard);
  if (pid < 0) throw std::system_error(error, std::generic_category(), "starting " + words.front());
  if (while_running) {
    pollfd ended{static_cast<int>(syscall(SYS_pidfd_open, pid, 0)), POLLIN, 0};
    while (ended.fd >= 0 && poll(&ended, 1, kLookEvery_ms) <= 0) while_running();
    if (ended.fd >= 0) close(ended.fd);
  }
  int status = 0;
  rusage usage{};
  while (wait4(pid, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  CommandResult end;
  end.exit_code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  end.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  end.processor_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  end.memory_mb = static_cast<double>(usage.ru_maxrss) / 1024.0;
  return end;
}

}  // namespace orchard::cli
