// SPDX-License-Identifier: BSD-3-Clause
#include "system/cli/cli_fixture.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace orchard::cli_test {
namespace {

std::string make_folder() {
  std::string name = (std::filesystem::temp_directory_path() / "orchard_cli_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  return name;
}

/// Files shared by all tests of this program; removed at its end.
struct Drive {
  Drive()
      : folder(make_folder()),
        log(folder + "/drive.lcm"),
        truth(folder + "/truth.csv"),
        config(ORCHARD_SOURCE_DIR "/config/tubes.yaml"),
        simulated(orchard({"simulate", "--scene", "tubes", "--seed", "3", "--out", log, "--truth",
                           truth, "--config", config})) {}
  ~Drive() { std::filesystem::remove_all(folder); }

  std::string folder;
  std::string log;
  std::string truth;
  std::string config;
  Result simulated;
};

const Drive& drive() {
  static const Drive instance;
  return instance;
}

}  // namespace

Result run(const std::vector<std::string>& arguments) {
  const std::string folder = make_folder();
  const std::string out = folder + "/out";
  const std::string err = folder + "/err";
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT, 0600);
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  pid_t pid = 0;
  Result result;
  if (posix_spawnp(&pid, argv[0], &actions, nullptr, argv.data(), environ) == 0) {
    int status = 0;
    waitpid(pid, &status, 0);
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  posix_spawn_file_actions_destroy(&actions);
  result.out = read_file(out);
  result.err = read_file(err);
  std::filesystem::remove_all(folder);
  return result;
}

Result orchard(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), ORCHARD_BUILD_DIR "/bin/orchard");
  return run(arguments);
}

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

void write_file(const std::string& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

bool exists(const std::string& path) { return std::filesystem::exists(path); }

int count_lines(const std::string& text) {
  return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
}

long num_messages(const std::string& log_path, const std::string& channel) {
  std::istringstream lines(orchard({"log", "info", log_path}).out);
  std::string line;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string name, type, role;
    long num = 0;
    if (words >> name >> type >> role >> num && name == channel) return num;
  }
  return 0;
}

void CliTest::SetUpTestSuite() {
  ASSERT_EQ(drive().simulated.exit_code, 0) << drive().simulated.err;
}

void CliTest::SetUp() { folder_ = make_folder(); }
void CliTest::TearDown() { std::filesystem::remove_all(folder_); }

Result CliTest::map(const std::string& log, const std::vector<std::string>& more) const {
  std::vector<std::string> arguments{"map", log, "--config", config(), "--out", path("map")};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return orchard(arguments);
}

const std::string& CliTest::log() { return drive().log; }
const std::string& CliTest::truth() { return drive().truth; }
const std::string& CliTest::config() { return drive().config; }

}  // namespace orchard::cli_test
