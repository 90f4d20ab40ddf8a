// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>
#include <array>
#include <cstdio>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "bus/process/process.hpp"
#include "cli/farm/farm.hpp"
#include "cli/farm/farm_folder.hpp"
#include "io/progress_bar.hpp"

namespace orchard::cli {
namespace {

using farm::FarmTask;
using farm::TaskKind;

constexpr std::array<TaskKind, 5> kKinds{TaskKind::kMap, TaskKind::kDate, TaskKind::kChanges,
                                         TaskKind::kReport, TaskKind::kPublish};

/// An event to report, and the drive or date that it concerns.
struct Finding {
  std::string what;  ///< "set aside (map)", "failed (map)", "left out", "not joined", "damaged" ...
  std::string of;
  std::string reason;
};

struct Counts {
  int num_good = 0, num_aside = 0, num_open = 0;
};

struct FarmState {
  std::array<Counts, kKinds.size()> counts;
  std::vector<Finding> findings;
  double open_s = 0.0;  ///< expected processor time of the open maps
};

/// Adds the maps that `merge --leave-out` left out of a date, and the earlier dates that none of
/// them fits, with reasons (left_out.csv).
void add_left_out(const FarmFolder& farm, const FarmTask& task, const std::vector<FarmTask>& tasks,
                  std::vector<Finding>& findings) {
  std::ifstream file(farm.path("results/" + task.name + "/left_out.csv"));
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    const std::string of_date = "\"results/date-";
    if (line.rfind(of_date, 0) == 0) {
      const std::size_t reason = line.find("\",\"") + 3;
      findings.push_back(
          {"not joined", task.title(), line.substr(reason, line.size() - reason - 1)});
    }
    for (const FarmTask& map : tasks) {
      const std::string begin = "\"results/" + map.name + "\",\"";
      if (line.rfind(begin, 0) != 0) continue;
      for (const farm::Drive& drive : map.drives) {
        if (drive.block != task.drives.front().block || drive.date != task.drives.front().date) {
          continue;
        }
        findings.push_back(
            {"left out", drive.title(), line.substr(begin.size(), line.size() - begin.size() - 1)});
      }
    }
  }
}

/// Adds what a map's summary tells of its log: damage, and seconds that no piece of it covers.
void add_warnings(const FarmFolder& farm, const FarmTask& task, std::vector<Finding>& findings) {
  std::ifstream file(farm.path("results/" + task.name + "/summary.json"));
  const auto summary = nlohmann::json::parse(file, nullptr, false);
  if (!summary.is_object() || !summary.contains("warnings")) return;
  std::string damage;
  for (const auto& warning : summary["warnings"]) {
    const auto text = warning.get<std::string>();
    if (text.rfind("nothing was recorded for", 0) == 0) {
      for (const farm::Drive& drive : task.drives) {
        findings.push_back({"pieces", drive.title(), text});
      }
    } else if (text.rfind("the log is damaged", 0) == 0 ||
               text.find(" messages refused: ") != std::string::npos) {
      damage += text + "; ";
    }
  }
  if (damage.empty()) return;
  for (const farm::Drive& drive : task.drives) {
    findings.push_back({"damaged", drive.title(), damage + "see `orchard log check`"});
  }
}

/// The name of a rig's copy gives way to that of the robot's rig.
std::string with_rig(std::string reason, const farm::Drive& drive) {
  const std::size_t at = drive.rig_path.empty() ? std::string::npos : reason.find(drive.rig_path);
  if (at != std::string::npos) {
    reason.replace(at, drive.rig_path.size(), "rigs/" + drive.robot + ".yaml");
  }
  return reason;
}

/// The lot of each step, in the last run.
std::map<std::string, std::string> lots_of_steps(const FarmFolder& farm) {
  std::ifstream file(farm.path(kLotsFile));
  std::map<std::string, std::string> lots;
  const auto phases = nlohmann::json::parse(file, nullptr, false);
  if (!phases.is_object()) return lots;
  for (const auto& phase : phases) {
    for (const auto& [lot, of_lot] : phase.items()) {
      for (const auto& step : of_lot["steps"]) lots[step.get<std::string>()] = lot;
    }
  }
  return lots;
}

/// What Slurm says of a job that it ended, from the job's output: why, if any line tells more than
/// that it was cancelled, since the order of these lines varies; empty: the job ended by itself.
std::string end_of_job(const std::string& path) {
  std::ifstream file(path);
  std::string end, why;
  for (std::string line; std::getline(file, line);) {
    if (line.empty()) continue;
    end = line.rfind("slurmstepd", 0) == 0 ? line : std::string();
    if (end.empty()) why.clear();
    if (end.find("CANCELLED") == std::string::npos && !end.empty()) why = end;
  }
  return end.empty() || why.empty() ? end : why;
}

/// Why the last attempt at an open step failed; empty: it did not, or is under way.
std::string failure_of(const FarmFolder& farm, const std::string& task,
                       const std::map<std::string, std::string>& lots) {
  const std::string said = last_line(farm.path("work/output/" + task + ".txt"));
  const std::string failed = kFailedWord;
  if (said.rfind(failed, 0) == 0) return said.substr(failed.size());
  const auto lot = lots.find(task);
  if (lot == lots.end()) return {};
  return end_of_job(farm.path("work/slurm/" + lot->second + ".txt"));
}

void add_open(const FarmFolder& farm, const FarmTask& task,
              const std::map<std::string, std::string>& lots, std::vector<Finding>& findings) {
  const std::string why = failure_of(farm, task.name, lots);
  if (why.empty()) return;
  findings.push_back({task.kind == TaskKind::kPublish
                          ? "not published"
                          : std::string("failed (") + farm::kind_text(task.kind) + ")",
                      task.title(), with_rig(why, task.drives.front())});
}

void add_set_aside(const FarmTask& task, const std::string& reason,
                   std::vector<Finding>& findings) {
  const std::string what = std::string("set aside (") + farm::kind_text(task.kind) + ")";
  if (task.kind != TaskKind::kMap) return findings.push_back({what, task.title(), reason});
  for (const farm::Drive& drive : task.drives) {
    findings.push_back({what, drive.title(), with_rig(reason, drive)});
  }
}

FarmState state_of(const FarmFolder& farm, const std::vector<FarmTask>& tasks,
                   const farm::StepCosts& costs) {
  FarmState state;
  const auto lots = lots_of_steps(farm);
  for (const FarmTask& task : tasks) {
    Counts& counts = state.counts[static_cast<std::size_t>(task.kind)];
    const auto made = farm.state_of(task.name);
    ++(!made ? counts.num_open : made->is_good ? counts.num_good : counts.num_aside);
    if (!made) {
      if (task.kind == TaskKind::kMap) {
        state.open_s += farm::expected_time_s(task, costs);
      }
      add_open(farm, task, lots, state.findings);
    } else if (!made->is_good) {
      add_set_aside(task, made->reason, state.findings);
    } else if (task.kind == TaskKind::kDate) {
      add_left_out(farm, task, tasks, state.findings);
    } else if (task.kind == TaskKind::kMap) {
      add_warnings(farm, task, state.findings);
    }
  }
  return state;
}

}  // namespace

void print_notes(const char* command, const FarmContent& content) {
  for (const std::string& note : content.notes) {
    std::fprintf(stderr, "orchard farm %s: note: %s\n", command, note.c_str());
  }
}

std::string status_text(const FarmFolder& farm, const FarmContent& content,
                        const std::vector<FarmTask>& tasks, bool json) {
  const FarmState state = state_of(farm, tasks, farm.costs(tasks));
  std::set<std::string> blocks, dates;
  for (const farm::Drive& drive : content.drives) {
    blocks.insert(drive.block);
    dates.insert(drive.block + "/" + drive.date);
  }
  if (json) {
    using nlohmann::ordered_json;
    ordered_json all{{"num_blocks", blocks.size()},
                     {"num_dates", dates.size()},
                     {"num_drives", content.drives.size()}};
    for (const TaskKind kind : kKinds) {
      const Counts& c = state.counts[static_cast<std::size_t>(kind)];
      all["steps"][farm::kind_text(kind)] = {
          {"good", c.num_good}, {"set_aside", c.num_aside}, {"open", c.num_open}};
    }
    all["notes"] = content.notes;
    all["findings"] = ordered_json::array();
    for (const Finding& f : state.findings) {
      all["findings"].push_back({{"what", f.what}, {"of", f.of}, {"reason", f.reason}});
    }
    all["open_s"] = state.open_s;
    // A note or a reason may name a file whose name is no UTF-8.
    return all.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
  }
  std::string text = fmt::format("{} blocks, {} dates, {} drives\n", blocks.size(), dates.size(),
                                 content.drives.size());
  for (const TaskKind kind : kKinds) {
    const Counts& c = state.counts[static_cast<std::size_t>(kind)];
    if (kind == TaskKind::kPublish && content.settings.publish_to.empty()) continue;
    text += fmt::format("{:<8} {:6} made, {:4} set aside, {:6} to make\n", farm::kind_text(kind),
                        c.num_good, c.num_aside, c.num_open);
  }
  for (const Finding& f : state.findings) {
    text += fmt::format("{}: {}: {}\n", f.what, f.of, f.reason);
  }
  if (state.open_s > 0.0) {
    text += fmt::format("the remaining maps will take about {} of one core\n",
                        io::waiting_text(state.open_s));
  }
  return text;
}

int run_farm_status(const FarmStatusOptions& options) {
  const FarmFolder farm(options.folder);
  const FarmContent content = farm.read();
  const auto tasks = farm.tasks_of(content);
  std::fputs(status_text(farm, content, tasks, options.json).c_str(), stdout);
  print_notes("status", content);
  return bus::kExitOk;
}

}  // namespace orchard::cli
