// SPDX-License-Identifier: BSD-3-Clause
#include "cli/farm/farm_list.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "io/atomic_file.hpp"
#include "io/companion.hpp"
#include "io/file_error.hpp"
#include "io/folder.hpp"

namespace orchard::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using Words = std::vector<std::string>;

constexpr const char* kListFile = "work/tasks.json";
constexpr const char* kAgain = "run `orchard farm run` again, which makes what it is now";

[[noreturn]] void refuse_input(const std::string& what, const char* advice) {
  throw io::SystemError(what + "; " + advice);
}

ordered_json entry_of(const farm::FarmTask& task) {
  const farm::Drive& first = task.drives.front();
  ordered_json entry{
      {"kind", farm::kind_text(task.kind)}, {"needs", task.needs}, {"edits", task.edits}};
  if (task.kind == farm::TaskKind::kMap) {
    entry["logs"] = first.log_paths;
    entry["rig"] = first.rig_path;
    entry["files"] = first.files;
  } else {
    entry["block"] = first.block;
    entry["date"] = first.date;
    entry["earlier"] = task.earlier;
    entry["max_offset_m"] = task.max_offset_m;
  }
  entry["of"] = ordered_json::array();
  for (const farm::Drive& drive : task.drives) entry["of"].push_back(drive.title());
  return entry;
}

/// Memory is 1.5 times what is expected, and time 5 times; a lot that fails requests more.
ordered_json lots_json(const std::vector<farm::Lot>& lots) {
  ordered_json json = ordered_json::object();
  for (const farm::Lot& lot : lots) {
    json[lot.name] = {{"steps", lot.steps},
                      {"memory_mb", std::ceil(200.0 + 1.5 * lot.memory_mb)},
                      {"time_s", std::ceil(60.0 + 5.0 * lot.time_s)}};
  }
  return json;
}

bool holds(const std::string& path, const std::string& text) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.find(text) != std::string::npos) return true;
  }
  return false;
}

}  // namespace

void write_list(const FarmFolder& farm, const FarmContent& content,
                const std::vector<farm::FarmTask>& tasks, const farm::Lots& lots) {
  io::make_folder(farm.path("work/rigs"));
  for (const auto& [copy, text] : content.rig_copies) {
    if (!fs::exists(farm.path(copy))) io::write_file_atomically(farm.path(copy), text);
  }
  ordered_json json;
  json["programs"] = farm.programs().digest;
  json["programs_identity"] = farm.programs().identity;
  json["any_place"] = content.settings.any_place;
  json["publish_to"] = content.settings.publish_to;
  json["tasks"] = ordered_json::object();
  for (const farm::FarmTask& task : tasks) json["tasks"][task.name] = entry_of(task);
  for (const auto* of_phase : {&lots.maps, &lots.others}) {
    for (const farm::Lot& lot : *of_phase) json["lots"][lot.name] = lot.steps;
  }
  io::write_file_atomically(farm.path(kListFile), json.dump(1) + "\n");
  const ordered_json for_engine{{"maps", lots_json(lots.maps)}, {"others", lots_json(lots.others)}};
  io::write_file_atomically(farm.path(kLotsFile), for_engine.dump(1) + "\n");
}

StepList::StepList(const FarmFolder& farm) : farm_(farm) {
  std::ifstream file(farm.path(kListFile));
  list_ = std::make_shared<nlohmann::json>(nlohmann::json::parse(file, nullptr, false));
  if (!list_->is_object() || !list_->contains("tasks")) {
    refuse_input(farm.path(kListFile) + " cannot be read", kAgain);
  }
  farm.know_programs({list_->value("programs_identity", ""), list_->value("programs", "")});
}

const nlohmann::json& StepList::entry(const std::string& step) const {
  const auto& tasks = list_->at("tasks");
  const auto found = tasks.find(step);
  if (found == tasks.end()) {
    refuse_input(step + " is not in the list of steps, " + kListFile, kAgain);
  }
  return *found;
}

std::vector<std::string> StepList::steps_of(const std::string& lot) const {
  const auto lots = list_->value("lots", nlohmann::json::object());
  if (lots.contains(lot)) return lots[lot];
  entry(lot);
  return {lot};
}

bool StepList::can_begin(const std::string& step) const {
  for (const char* kind : {"needs", "earlier"}) {
    for (const auto& need : entry(step).value(kind, Words())) {
      if (!farm_.is_made(need)) return false;
    }
  }
  return true;
}

std::vector<std::string> StepList::good(const Words& results) const {
  Words folders;
  for (const std::string& result : results) {
    const auto state = farm_.state_of(result);
    if (state && state->is_good) folders.push_back("results/" + result);
  }
  return folders;
}

StepCommand StepList::command_of(const std::string& step) const {
  const auto& task = entry(step);
  const auto kind = task["kind"].get<std::string>();
  Words words;
  const auto add = [&words](const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
  };
  if (kind == "map") {
    const auto rig = task["rig"].get<std::string>();
    add({"map"}), add(task["logs"]);
    if (!rig.empty()) add({"--config", rig});
    add({"--quiet", "--no-derived", "--jobs", "1", "--out", "@out"});
    return {words, {}};
  }
  const Words now = good(task["needs"]), earlier = good(task.value("earlier", Words()));
  const auto block = task["block"].get<std::string>(), date = task["date"].get<std::string>();
  const Words lay =
      list_->at("any_place").get<bool>()
          ? Words{"--any-place"}
          : Words{"--max-offset", fmt::format("{:g}", task["max_offset_m"].get<double>())};
  if (kind == "date") {
    // Ids and numbers are those of the latest previous date that one of the drives fits.
    if (now.empty()) return {{}, "no drive of this date gave a map"};
    add({"merge"}), add(now), add({"--leave-out"});
    std::for_each(earlier.rbegin(), earlier.rend(), [&](const std::string& one) {
      add({"--previous", one});
    });
    add(lay), add({"--out", "@out"});
  } else if (kind == "changes") {
    // Since the date whose ids this one carries on: the latest that its merge did not refuse.
    std::string before;
    for (const std::string& one : earlier) {
      if (now.empty() || holds(farm_.path(now[0] + "/left_out.csv"), "\"" + one + "\"")) continue;
      before = one;
    }
    if (before.empty()) return {{}, "no map of an earlier date fits one of this date"};
    add({"compare", before, now[0]}), add(lay), add({"--out", "@out"});
  } else if (now.empty()) {
    return {{}, "there is no map of this date"};
  } else if (kind == "report") {
    add({"report", now[0], "--name=" + block + " " + date, "--out", "@out"});
  } else {
    add({"publish", now[0], "--to", list_->at("publish_to"), "--block=" + block, "--date", date});
  }
  return {words, {}};
}

void StepList::require_inputs(const std::string& step) const {
  const auto& task = entry(step);
  if (list_->at("programs") != farm_.programs().digest) {
    refuse_input("the programs in " + io::program_folder() +
                     " or the Snakefile are not those of `orchard farm run`",
                 "install the same programs on all machines, or run it again");
  }
  const auto files = task.value("files", nlohmann::json::object());
  for (const auto& [name, digest] : files.items()) {
    const std::string file = (fs::path(farm_.root()) / name).string();
    const bool is_absent = digest == "" && !fs::exists(file);
    if (!is_absent && digest_of_files({file}) != digest) {
      refuse_input(file + " has changed since `orchard farm run` began", kAgain);
    }
  }
  for (const auto& [date, edits] : task["edits"].items()) {
    if (farm_.edits_of(date) != edits) {
      refuse_input("the corrections of results/" + date + " have changed", kAgain);
    }
  }
  for (const char* kind : {"needs", "earlier"}) {
    for (const auto& need : task.value(kind, Words())) {
      const std::string damage = farm_.damage_of(need);
      if (!damage.empty()) {
        refuse_input("results/" + need + ": " + damage,
                     "remove it with `orchard farm retry`, and run `orchard farm run` again");
      }
    }
  }
}

}  // namespace orchard::cli
