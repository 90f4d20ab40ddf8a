// SPDX-License-Identifier: BSD-3-Clause
#include "cli/farm/farm_files.hpp"

#include <cstdio>
#include <filesystem>
#include <regex>

#include "bus/process/process.hpp"
#include "cli/farm/farm_folder.hpp"
#include "io/atomic_file.hpp"
#include "io/file_error.hpp"
#include "io/folder.hpp"

namespace orchard::cli {
namespace {

namespace fs = std::filesystem;

void require_word(const char* option, const std::string& word) {
  if (is_farm_name(word)) return;
  throw io::FileError(std::string(option) + " " + word +
                      ": a name in a farm may only have letters, digits, \".\", \"-\" and \"_\"");
}

}  // namespace

int run_farm_init(const FarmInitOptions& options) {
  for (const char* folder : {"logs", "rigs", "plans"})
    io::make_folder(options.folder + "/" + folder);
  for (int i = 0; i < kNumFarmFiles; ++i) {
    const std::string path = options.folder + "/" + kFarmFiles[i].name;
    const bool is_users = std::string(kFarmFiles[i].name) == "farm.yaml";
    if (fs::exists(path) && (is_users || !options.renew)) {
      std::printf("%s exists and was not changed\n", path.c_str());
      continue;
    }
    io::make_folder(fs::path(path).parent_path().string());
    io::write_file_atomically(path, kFarmFiles[i].text);
    if (path.size() > 3 && path.substr(path.size() - 3) == ".sh") {
      fs::permissions(path, fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec,
                      fs::perm_options::add);
    }
  }
  std::printf(
      "farm created in %s. Put logs into logs/BLOCK/DATE/ROBOT/ (or run `orchard farm add %s LOG "
      "--block B --date D --robot R`),\n"
      "  and rigs that replace those stored in the logs into rigs/ROBOT.yaml; then run `orchard "
      "farm run %s`\n",
      options.folder.c_str(), options.folder.c_str(), options.folder.c_str());
  return bus::kExitOk;
}

int run_farm_add(const FarmAddOptions& options) {
  const FarmFolder farm(options.folder);
  require_word("--block", options.block);
  require_word("--robot", options.robot);
  static const std::regex kDate("[0-9]{4}-[0-9]{2}-[0-9]{2}");
  if (!std::regex_match(options.date, kDate)) {
    throw io::FileError("--date " + options.date + ": not a date; write it like 2026-05-31");
  }
  const std::string folder =
      farm.path("logs/" + options.block + "/" + options.date + "/" + options.robot);
  for (const std::string& log : options.log_paths) {
    const std::string name = fs::path(log).filename().string();
    static const std::regex kLog(".+\\.lcm(\\.[0-9]+)?");
    if (!is_farm_name(name) || !std::regex_match(name, kLog)) {
      throw io::FileError(log +
                          ": not the name of a log in a farm; rename it to NAME.lcm (parts of a "
                          "split log: NAME.lcm.00 ...)");
    }
    const std::string place = folder + "/" + name;
    if (fs::exists(place)) {
      if (digest_of_files({place}) != digest_of_files({log})) {
        throw io::FileError(place + " exists already and differs from " + log);
      }
      std::printf("%s exists already with the same content\n", place.c_str());
      continue;
    }
    io::make_folder(folder);
    // Atomic, so that a concurrent run of the farm never reads an incomplete log.
    io::replace_file_atomically(place, [&](const std::string& temporary) {
      std::error_code error;
      fs::copy_file(log, temporary, fs::copy_options::overwrite_existing, error);
      if (error) throw io::FileError(log + " could not be copied (" + error.message() + ")");
    });
    std::printf("%s\n", place.c_str());
  }
  return bus::kExitOk;
}

}  // namespace orchard::cli
