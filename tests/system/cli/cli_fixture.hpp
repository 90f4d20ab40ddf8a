// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace orchard::cli_test {

/// The first line of a map.csv.
inline constexpr const char* kMapHeader =
    "id,class,x_m,y_m,n,roc_mean,probability,se_x_m,se_y_m,width_m,row,position\n";

/// How a program ended and what it said.
struct Result {
  int exit_code = -1;  ///< 128 + signal when it was killed
  std::string out;
  std::string err;
};

/// Runs a program of the build (or one found in PATH) to its end, with no terminal.
Result run(const std::vector<std::string>& arguments);

/// Runs `orchard` with these arguments.
Result orchard(std::vector<std::string> arguments);

std::string read_file(const std::string& path);
void write_file(const std::string& path, const std::string& content);
bool exists(const std::string& path);
int count_lines(const std::string& text);

/// Messages of a channel that `orchard log info` counts in a log; 0 when it names none.
long num_messages(const std::string& log_path, const std::string& channel);

/// An empty folder for each test, and one simulated drive for all of them.
class CliTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite();
  void SetUp() override;
  void TearDown() override;

  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  Result map(const std::string& log, const std::vector<std::string>& more = {}) const;

  static const std::string& log();     ///< a drive through the tube scene
  static const std::string& truth();   ///< its truth CSV
  static const std::string& config();  ///< its rig

 private:
  std::string folder_;
};

}  // namespace orchard::cli_test
