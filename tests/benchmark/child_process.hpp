// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace orchard::bench {

/// A program that runs beside this one; killed when its owner ends without stop() or wait().
class ChildProcess {
 public:
  /// Starts a program with its standard output and error in a file. Throws std::runtime_error.
  ChildProcess(const std::vector<std::string>& arguments, const std::string& log_path);
  ~ChildProcess();
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;

  /// SIGINT, then its exit code (128 + signal when it was killed).
  int stop();
  /// SIGSTOP, SIGCONT ...
  void signal(int number);
  /// Waits for its end.
  int wait();

  /// User and system time of all its threads so far, in steps of 10 ms [s].
  double cpu_s() const;

  const std::string& name() const { return name_; }

 private:
  pid_t pid_ = -1;
  std::string name_;
};

/// The path of a program in build/bin.
std::string built_program(const std::string& name);
/// The path of the program that runs.
std::string this_program();

/// A folder that is removed with everything in it at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::string path(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

}  // namespace orchard::bench
