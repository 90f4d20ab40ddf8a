// SPDX-License-Identifier: BSD-3-Clause
#include "bus/replay/logged_rig.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "bus/messages/channel.hpp"
#include "bus/messages/service_messages.hpp"
#include "bus/network.hpp"
#include "io/config/config_difference.hpp"
#include "io/config/config_file.hpp"
#include "io/file_error.hpp"

namespace orchard::bus {
namespace {

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

[[noreturn]] void refuse_disagreement(const std::string& log_path, const LoggedRig& a,
                                      const LoggedRig& b,
                                      const std::vector<io::ConfigDifference>& differences) {
  std::string text =
      fmt::format("{} was recorded with different configurations ({} -> {}):", log_path,
                  fmt::join(a.processes, ", "), fmt::join(b.processes, ", "));
  for (const std::string& line : io::difference_lines(differences)) text += "\n  " + line;
  throw io::FileError(text +
                      "\n"
                      "give one with --config FILE; `orchard log config " +
                      log_path + " --process " + b.processes.front() + "` prints the second one");
}

}  // namespace

std::vector<LoggedRig> read_logged_rigs(const io::LogPaths& logs) {
  const std::string_view channel = info(Channel::kConfig).name;
  std::vector<LoggedRig> rigs;
  io::LogSeries reader(logs);
  while (const auto event = reader.next()) {
    require_no_robot(event->channel, logs.text());
    if (event->channel != channel) continue;
    auto decoded = decode_config(event->data.data(), event->data.size());
    auto* notice = std::get_if<ConfigNotice>(&decoded);
    if (notice == nullptr || io::text_hash(notice->text) != notice->hash) continue;
    const auto same = std::find_if(rigs.begin(), rigs.end(),
                                   [&](const LoggedRig& rig) { return rig.yaml == notice->text; });
    if (same == rigs.end()) {
      rigs.push_back({{notice->name}, notice->version, std::move(notice->text)});
    } else if (!contains(same->processes, notice->name)) {
      same->processes.push_back(notice->name);
    }
  }
  return rigs;
}

LoggedRig rig_of_log(const io::LogPaths& logs, const std::string& process) {
  const std::string log_path = logs.text();
  std::vector<LoggedRig> rigs = read_logged_rigs(logs);
  if (rigs.empty()) {
    throw io::FileError(
        log_path +
        " has no CONFIG message with the rig of the recording; give the rig with --config FILE");
  }
  if (!process.empty()) {
    std::vector<std::string> names;
    for (const LoggedRig& rig : rigs) {
      names.insert(names.end(), rig.processes.begin(), rig.processes.end());
    }
    rigs.erase(
        std::remove_if(rigs.begin(), rigs.end(),
                       [&](const LoggedRig& rig) { return !contains(rig.processes, process); }),
        rigs.end());
    if (rigs.empty()) {
      throw io::FileError(fmt::format("{} has no CONFIG of {}, only of {}", log_path, process,
                                      fmt::join(names, ", ")));
    }
    return rigs.back();  // a restarted process: its last configuration
  }
  for (std::size_t i = 1; i < rigs.size(); ++i) {
    const auto differences = io::config_differences(rigs.front().yaml, rigs[i].yaml);
    if (!differences.empty()) refuse_disagreement(log_path, rigs.front(), rigs[i], differences);
  }
  return rigs.front();
}

}  // namespace orchard::bus
