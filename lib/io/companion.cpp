// SPDX-License-Identifier: BSD-3-Clause
#include "io/companion.hpp"

#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "io/file_error.hpp"

namespace orchard::io {
namespace {

/// A file in memory, which the other process fills; unlike a pipe it never stops that process.
class Output {
 public:
  Output() : fd_(::memfd_create("output", MFD_CLOEXEC)) {
    if (fd_ < 0) throw FileError("another program could not be started (memory)");
  }
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;
  ~Output() { ::close(fd_); }
  int fd() const { return fd_; }
  std::string text() const {
    std::ifstream file("/proc/self/fd/" + std::to_string(fd_), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

 private:
  int fd_;
};

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
  const Output out, err;
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, out.fd(), STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, err.fd(), STDERR_FILENO);
  pid_t child = -1;
  const int error = ::posix_spawn(&child, path.c_str(), &actions, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    throw SystemError(path + ": could not be started (" + std::strerror(error) +
                      "); it must be in the same folder as this program: build it with "
                      "`scripts/build.sh " +
                      program + "`");
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  std::string said = err.text();
  while (!said.empty() && said.back() == '\n') said.pop_back();
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw FileError(said.empty() ? path + " failed without a message" : said);
  }
  if (!said.empty()) std::fprintf(stderr, "%s\n", said.c_str());
  return out.text();
}

}  // namespace orchard::io
