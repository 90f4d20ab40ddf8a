// SPDX-License-Identifier: BSD-3-Clause
#include "cli/farm/farm_status.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "bus/process/process.hpp"

namespace orchard::cli {
namespace {

using farm::FarmTask;
using farm::TaskKind;

constexpr std::array<TaskKind, 6> kKinds{TaskKind::kCheck,   TaskKind::kMap,    TaskKind::kDate,
                                         TaskKind::kChanges, TaskKind::kReport, TaskKind::kPublish};

/// An event to report, and the drive or date that it concerns.
struct Finding {
  std::string what;  ///< "set aside", "left out", "damaged", "not published"
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

std::string title_of(const FarmTask& task) {
  const farm::Drive& drive = task.drives.front();
  return task.kind == TaskKind::kCheck || task.kind == TaskKind::kMap
             ? drive.title()
             : drive.block + "/" + drive.date;
}

/// Adds the maps that `merge --leave-out` left out of a date, with reasons (left_out.csv).
void add_left_out(const FarmFolder& farm, const FarmTask& task, const std::vector<FarmTask>& tasks,
                  std::vector<Finding>& findings) {
  std::ifstream file(farm.path("results/" + task.name + "/left_out.csv"));
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
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

/// What a step said last that was begun and gave no result; empty: none was begun.
std::string refusal_of(const FarmFolder& farm, const FarmTask& task) {
  std::ifstream file(farm.path("work/output/" + task.name + ".txt"));
  std::string last;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty()) last = line;
  }
  return last;
}

bool is_damaged(const FarmFolder& farm, const FarmTask& task) {
  std::ifstream file(farm.path("results/" + task.name + "/said.txt"));
  const auto said = nlohmann::json::parse(file, nullptr, false);
  return !said.is_object() || !said.value("sound", false);
}

FarmState state_of(const FarmFolder& farm, const std::vector<FarmTask>& tasks,
                   const farm::CostFit& costs) {
  FarmState state;
  std::set<std::string> mapped;  // digests of logs
  for (const FarmTask& task : tasks) {
    const auto made = farm.state_of(task.name);
    if (task.kind == TaskKind::kMap && made && made->is_good) {
      mapped.insert(task.drives.front().log_digest);
    }
  }
  for (const FarmTask& task : tasks) {
    Counts& counts = state.counts[static_cast<std::size_t>(task.kind)];
    const auto made = farm.state_of(task.name);
    ++(!made ? counts.num_open : made->is_good ? counts.num_good : counts.num_aside);
    if (!made) {
      if (task.kind == TaskKind::kMap) {
        state.open_s += costs.ask_s.at_least +
                        costs.ask_s.per_mb * 1e-6 * static_cast<double>(task.drives[0].num_bytes);
      }
      if (task.kind == TaskKind::kPublish) {
        const std::string why = refusal_of(farm, task);
        if (!why.empty()) state.findings.push_back({"not published", title_of(task), why});
      }
      continue;
    }
    if (!made->is_good) {
      for (const farm::Drive& drive : task.drives) {
        const bool is_of_drive = task.kind == TaskKind::kMap || task.kind == TaskKind::kCheck;
        state.findings.push_back({std::string("set aside (") + farm::kind_text(task.kind) + ")",
                                  is_of_drive ? drive.title() : title_of(task), made->reason});
        if (!is_of_drive) break;
      }
    } else if (task.kind == TaskKind::kDate) {
      add_left_out(farm, task, tasks, state.findings);
    } else if (task.kind == TaskKind::kCheck && is_damaged(farm, task) &&
               mapped.count(task.drives.front().log_digest) > 0) {
      for (const farm::Drive& drive : task.drives) {
        state.findings.push_back(
            {"damaged", drive.title(), "the readable part was mapped; see `orchard log check`"});
      }
    }
  }
  return state;
}

std::string cost_text(const char* what, const char* unit, const farm::CostLine& line) {
  return fmt::format("{}: {:.2f} {} + {:.2f} {} per km + {:.4f} {} per tree", what, line.at_least,
                     unit, line.per_km, unit, line.per_tree, unit);
}

}  // namespace

std::string status_text(const FarmFolder& farm, const FarmContent& content,
                        const std::vector<FarmTask>& tasks, bool json) {
  const auto samples = farm.costs(tasks);
  const farm::CostFit costs = farm::fit_costs(samples);
  const FarmState state = state_of(farm, tasks, costs);
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
    all["findings"] = ordered_json::array();
    for (const Finding& f : state.findings) {
      all["findings"].push_back({{"what", f.what}, {"of", f.of}, {"reason", f.reason}});
    }
    const auto line = [](const farm::CostLine& l) {
      return ordered_json{{"at_least", l.at_least}, {"per_km", l.per_km}, {"per_tree", l.per_tree}};
    };
    all["map_cost"] = {{"num_maps", samples.size()},
                       {"time_s", line(costs.time_s)},
                       {"memory_mb", line(costs.memory_mb)}};
    all["open_s"] = state.open_s;
    return all.dump(2) + "\n";
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
  if (!samples.empty()) {
    text += fmt::format("cost of a map, fitted to {} maps: {}; {}\n", samples.size(),
                        cost_text("core time", "s", costs.time_s),
                        cost_text("memory", "MB", costs.memory_mb));
  }
  if (state.open_s > 0.0) {
    text += fmt::format("the remaining maps will take about {:.0f} s of one core\n", state.open_s);
  }
  return text;
}

int run_farm_status(const FarmStatusOptions& options) {
  const FarmFolder farm(options.folder);
  const FarmContent content = farm.read();
  const auto tasks = farm.tasks_of(content);
  farm.write_tasks(content, tasks, farm::fit_costs(farm.costs(tasks)));
  std::fputs(status_text(farm, content, tasks, options.json).c_str(), stdout);
  for (const std::string& note : content.notes) {
    std::fprintf(stderr, "orchard farm status: note: %s\n", note.c_str());
  }
  return bus::kExitOk;
}

}  // namespace orchard::cli
