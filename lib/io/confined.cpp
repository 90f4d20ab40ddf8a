// SPDX-License-Identifier: BSD-3-Clause
#include "io/confined.hpp"

#include <fcntl.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <exception>
#include <fstream>
#include <new>
#include <utility>

#include "io/file_error.hpp"

namespace orchard::io {
namespace {

constexpr bool has_sanitizer() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
  return true;
#else
  return false;
#endif
#else
  return false;
#endif
}

constexpr char kResult = 'R', kError = 'E';

// derived: GDAL and its tables take 60 MiB before the first byte; KML takes most for what it reads:
// 10 times its size for 100,000 trees. Twice that.
constexpr std::uint64_t kSpareBytes = std::uint64_t{96} << 20;
constexpr std::uint64_t kMemoryPerByte = 20;
// derived: the slowest reader, of KML, needs 0.25 s for a MiB, on a busy computer; four times that.
constexpr std::uint64_t kSpareSeconds = 3;
constexpr std::uint64_t kBytesPerSecond = std::uint64_t{1} << 20;

std::uint64_t memory_bytes_max(std::uint64_t file_bytes) {
  return kSpareBytes + kMemoryPerByte * file_bytes;
}
std::uint64_t seconds_max(std::uint64_t file_bytes) {
  return kSpareSeconds + file_bytes / kBytesPerSecond;
}

void limit(int resource, std::uint64_t most) {
  rlimit now{};
  ::getrlimit(static_cast<__rlimit_resource_t>(resource), &now);
  now.rlim_cur = std::min<rlim_t>(now.rlim_max, static_cast<rlim_t>(most));
  ::setrlimit(static_cast<__rlimit_resource_t>(resource), &now);
}

/// Limits the growth of this process. Not under sanitizers, which reserve all address space.
void limit_memory(std::uint64_t more_bytes) {
  std::uint64_t num_pages = 0;
  std::ifstream("/proc/self/statm") >> num_pages;
  const auto page_bytes = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  if (!has_sanitizer() && num_pages > 0) limit(RLIMIT_AS, num_pages * page_bytes + more_bytes);
}

/// Makes the system calls that open a connection or start a program fail from now on. Guards
/// against readers that follow a link, not against code that takes one over. False: the kernel
/// cannot.
bool forbid_connections() {
  constexpr std::array kForbidden{SYS_socket, SYS_io_uring_setup, SYS_execve, SYS_execveat};
  std::array<sock_filter, kForbidden.size() + 3> filter{};
  filter.front() = BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr));
  for (std::size_t i = 0; i < kForbidden.size(); ++i) {
    const auto to_refusal = static_cast<std::uint8_t>(kForbidden.size() - i);
    filter[i + 1] = BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(kForbidden[i]),
                             to_refusal, 0);
  }
  filter[kForbidden.size() + 1] = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
  filter[kForbidden.size() + 2] = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EACCES);
  const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
  return ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

/// Libraries print; the child reports through its pipe only.
void silence() {
  const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (null >= 0) ::dup2(null, fd);
  }
}

void write_all(int fd, const std::string& bytes) {
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t count = ::write(fd, bytes.data() + at, bytes.size() - at);
    if (count > 0) at += static_cast<std::size_t>(count);
    if (count < 0 && errno != EINTR) return;
  }
}

[[noreturn]] void run_child(const std::string& path, std::uint64_t file_bytes,
                            const std::function<std::string()>& read, int pipe_end) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int number : {SIGINT, SIGTERM, SIGXCPU}) std::signal(number, SIG_DFL);
  silence();
  char kind = kError;
  std::string text;
  try {
    limit_memory(memory_bytes_max(file_bytes));
    limit(RLIMIT_CPU, seconds_max(file_bytes));
    limit(RLIMIT_CORE, 0);
    if (!forbid_connections()) {
      throw FileError(path +
                      ": is not read, because this kernel cannot keep the reader from the network; "
                      "it needs seccomp filters (CONFIG_SECCOMP_FILTER)");
    }
    text = read();
    kind = kResult;
  } catch (const std::bad_alloc&) {
    ::_exit(SIGKILL);  // as by the kernel, for want of memory: see message_of()
  } catch (const std::exception& error) {
    text = error.what();
  }
  write_all(pipe_end, std::string(1, kind));
  write_all(pipe_end, text);
  ::_exit(0);
}

/// Why a child gave no result.
std::string message_of(const std::string& path, std::uint64_t file_bytes, int status) {
  const bool is_late = WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU;
  const std::string budget =
      is_late ? std::to_string(seconds_max(file_bytes)) + " s of the processor"
              : std::to_string(memory_bytes_max(file_bytes) >> 20) + " MiB of memory";
  return path + ": cannot be read within " + budget + ", which is enough for a file of " +
         std::to_string(file_bytes) + " bytes: it is damaged, or made to exhaust who reads it";
}

std::string read_to_end(int fd) {
  std::string text;
  std::array<char, 65536> buffer{};
  ssize_t count = 0;
  while ((count = ::read(fd, buffer.data(), buffer.size())) > 0 || (count < 0 && errno == EINTR)) {
    if (count > 0) text.append(buffer.data(), static_cast<std::size_t>(count));
  }
  return text;
}

}  // namespace

std::string read_confined(const std::string& path, std::uint64_t file_bytes,
                          const std::function<std::string()>& read) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw SystemError(path + ": its reader cannot start (pipe)");
  const pid_t child = ::fork();
  if (child == 0) run_child(path, file_bytes, read, ends[1]);
  ::close(ends[1]);
  std::string said = child > 0 ? read_to_end(ends[0]) : std::string();
  ::close(ends[0]);
  if (child < 0) throw SystemError(path + ": its reader cannot start (process)");
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const bool is_done = WIFEXITED(status) && WEXITSTATUS(status) == 0 && !said.empty();
  if (!is_done) throw FileError(message_of(path, file_bytes, status));
  const char kind = said.front();
  said.erase(0, 1);
  if (kind == kError) throw FileError(said);
  return said;
}

}  // namespace orchard::io
