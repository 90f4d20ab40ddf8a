// SPDX-License-Identifier: BSD-3-Clause
#include "io/companion.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

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

  /// All that is written until the other process ends.
  std::string read_all() {
    close_end(1);
    std::string text;
    char buffer[65536];
    for (ssize_t count; (count = ::read(ends_[0], buffer, sizeof(buffer))) != 0;) {
      if (count > 0) text.append(buffer, static_cast<std::size_t>(count));
      if (count < 0 && errno != EINTR) break;
    }
    return text;
  }

 private:
  void close_end(int end) {
    if (ends_[end] >= 0) ::close(ends_[end]);
    ends_[end] = -1;
  }
  int ends_[2] = {-1, -1};
};

}  // namespace

std::string program_folder() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error)
    throw FileError(
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
    throw FileError(path + ": could not be started (" + std::strerror(error) +
                    "); it must be in the same folder as this program: build it with "
                    "`scripts/build.sh " +
                    program + "`");
  }
  std::string text = out.read_all();
  std::string said = err.read_all();  // a few lines, which fit into the pipe until they are read
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  while (!said.empty() && said.back() == '\n') said.pop_back();
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw FileError(said.empty() ? path + " failed without a message" : said);
  }
  if (!said.empty()) std::fprintf(stderr, "%s\n", said.c_str());
  return text;
}

}  // namespace orchard::io
