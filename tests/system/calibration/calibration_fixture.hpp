// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace orchard {

/// How a command ended and what it printed.
struct Outcome {
  int exit_code = -1;
  std::string output;  ///< standard output, and error where it was asked for
};

/// Runs a program of the build, `orchard` unless named, with arguments as a shell reads them.
inline Outcome run(const std::string& arguments, bool with_errors = true,
                   const std::string& program = "bin/orchard") {
  Outcome outcome;
  const std::string command =
      ORCHARD_BUILD_DIR "/" + program + " " + arguments + (with_errors ? " 2>&1" : " 2>/dev/null");
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return outcome;
  std::array<char, 512> buffer;
  while (std::fgets(buffer.data(), static_cast<int>(buffer.size()), pipe)) {
    outcome.output += buffer.data();
  }
  const int status = pclose(pipe);
  if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
  return outcome;
}

inline std::string text_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

/// An empty folder for each test.
class CalibrationTest : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("orchard_calibration_" + std::to_string(getpid()));
};

}  // namespace orchard
