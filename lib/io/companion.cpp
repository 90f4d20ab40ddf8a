// SPDX-License-Identifier: BSD-3-Clause
#include "io/companion.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "io/file_error.hpp"

namespace orchard::io {
namespace {

/// A pipe whose ends close with it, and in child processes.
class Pipe {
 public:
  Pipe() {
    if (::pipe2(ends_, O_CLOEXEC) != 0)
      throw FileError("another program could not be started (pipe)");
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  int writing_end() const { return ends_[1]; }

  /// Ends this process' own writing, so that reading ends with the other process.
  void begin_reading() { close_end(1); }
  int reading_end() const { return ends_[0]; }

  /// Appends what is there; closes the pipe at its end.
  void read_some() {
    char buffer[65536];
    const ssize_t count = ::read(ends_[0], buffer, sizeof(buffer));
    if (count > 0) text.append(buffer, static_cast<std::size_t>(count));
    if (count == 0 || (count < 0 && errno != EINTR)) close_end(0);
  }

  std::string text;  ///< read so far

 private:
  void close_end(int end) {
    if (ends_[end] >= 0) ::close(ends_[end]);
    ends_[end] = -1;
  }
  int ends_[2] = {-1, -1};
};

/// Reads both pipes until the other process ends. In turn, because a full pipe stops that process.
void read_all(Pipe& out, Pipe& err) {
  out.begin_reading();
  err.begin_reading();
  while (out.reading_end() >= 0 || err.reading_end() >= 0) {
    // A closed end is negative, which poll() passes over.
    std::array<pollfd, 2> ends{{{out.reading_end(), POLLIN, 0}, {err.reading_end(), POLLIN, 0}}};
    if (::poll(ends.data(), ends.size(), -1) < 0) continue;
    if (ends[0].revents != 0) out.read_some();
    if (ends[1].revents != 0) err.read_some();
  }
}

}  // namespace

std::string program_folder() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error)
    throw SystemError(
        "the folder of orchard's programs cannot be determined: /proc/self/exe cannot be read");
  return self.parent_path().string();
}

std::string output_of_companion(const std::string& program,
                                const std::vector<std::string>& arguments) {
  const std::string path = program_folder() + "/" + program;
  std::vector<std::string> words{path};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  Pipe out, err;
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, out.writing_end(), STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, err.writing_end(), STDERR_FILENO);
  pid_t child = -1;
  const int error = ::posix_spawn(&child, path.c_str(), &actions, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    throw SystemError(path + ": could not be started (" + std::strerror(error) +
                      "); it must be in the same folder as this program: build it with "
                      "`scripts/build.sh " +
                      program + "`");
  }
  read_all(out, err);
  std::string& said = err.text;
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  while (!said.empty() && said.back() == '\n') said.pop_back();
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw FileError(said.empty() ? path + " failed without a message" : said);
  }
  if (!said.empty()) std::fprintf(stderr, "%s\n", said.c_str());
  return std::move(out.text);
}

}  // namespace orchard::io
