// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "cli/add_command.hpp"
#include "io/companion.hpp"
#include "io/file_error.hpp"

namespace orchard::cli {
namespace {

/// The commands that are not in `orchard` itself, and the program that has each.
struct Place {
  const char* command;
  const char* program;
};
constexpr Place kElsewhere[] = {
    {"orchard calibrate", "orchard-calibrate"},  // their solvers take long to compile
    {"orchard import", "orchard-import"},        // recordings of other systems
    {"orchard log mcap", "orchard-import"},
    {"orchard compare", "orchard-maps"},  // finished maps
    {"orchard edit", "orchard-gis"},      // files of GIS
    {"orchard evaluate localisation", "orchard-maps"},
    {"orchard evaluate trajectory", "orchard-gis"},  // reads surveys
    {"orchard export", "orchard-gis"},
    {"orchard farm", "orchard-maps"},
    {"orchard import-edits", "orchard-gis"},
    {"orchard merge", "orchard-maps"},
    {"orchard plan", "orchard-gis"},
    {"orchard publish", "orchard-maps"},
    {"orchard report", "orchard-maps"},
    {"orchard tasks", "orchard-gis"},
    {"orchard view", "orchard-maps"},
};

/// The arguments of this process, each null-terminated.
std::string own_command_line() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

std::string title_of(const CLI::App& command) {
  const CLI::App* parent = command.get_parent();
  return (parent ? title_of(*parent) + " " : "") + command.get_name();
}

const char* program_of(const CLI::App& command) {
  const std::string title = title_of(command) + " ";
  for (const Place& place : kElsewhere) {
    if (title.rfind(std::string(place.command) + " ", 0) == 0) return place.program;
  }
  return "orchard";
}

int replace_by_program(const char* program) {
  const std::string path = io::program_folder() + "/" + program;
  std::error_code error;
  if (std::filesystem::equivalent(path, "/proc/self/exe", error)) {  // it would run itself for ever
    throw io::SystemError(path +
                          " lacks the command that it is there for, as if it were another program "
                          "under this name; build all programs anew with scripts/build.sh, or "
                          "install the package again");
  }
  std::string words = own_command_line();
  std::vector<char*> arguments;
  for (std::size_t begin = 0, end; (end = words.find('\0', begin)) != words.npos; begin = end + 1) {
    arguments.push_back(&words[begin]);
  }
  arguments.push_back(nullptr);
  errno = ENOENT;
  if (arguments.size() > 1) execv(path.c_str(), arguments.data());
  throw io::FileError(
      path + ": could not be started (" + std::strerror(errno) +
      "); it must be in the same folder as orchard: build it with `scripts/build.sh " + program +
      "`");
}

}  // namespace orchard::cli
