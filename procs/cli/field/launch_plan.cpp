// SPDX-License-Identifier: BSD-3-Clause
#include "cli/field/launch_plan.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "bus/messages/channel.hpp"
#include "bus/node/process_options.hpp"
#include "cli/rig/suggestion.hpp"
#include "io/file_error.hpp"
#include "io/log/log_reader.hpp"

namespace orchard::cli {
namespace {

enum Stage { kDrivers, kDetector, kPose, kMapper, kRecorder };

/// A driver, its channel, and the address of its device in the rig.
struct KnownDriver {
  const char* name;
  std::optional<bus::Channel> channel;  ///< none: converts several channels of other programs
  const std::string& (*device)(const device::DriversConfig& drivers);
};

using Drivers = device::DriversConfig;
const KnownDriver kDriversKnown[] = {
    {"orchard-laser-driver", bus::Channel::kScan,
     [](const Drivers& d) -> const std::string& { return d.laser.device; }},
    {"orchard-rear-laser-driver", bus::Channel::kScanRear,
     [](const Drivers& d) -> const std::string& { return d.laser_rear.device; }},
    {"orchard-camera-driver", bus::Channel::kImage,
     [](const Drivers& d) -> const std::string& { return d.camera.device; }},
    {"orchard-odometry-driver", bus::Channel::kOdometry,
     [](const Drivers& d) -> const std::string& { return d.odometry.device; }},
    {"orchard-imu-driver", bus::Channel::kImu,
     [](const Drivers& d) -> const std::string& { return d.imu.device; }},
    {"orchard-gnss-driver", bus::Channel::kGnss,
     [](const Drivers& d) -> const std::string& { return d.gnss.device; }},
    {"orchard-bot-core-adapter", std::nullopt,
     [](const Drivers& d) -> const std::string& { return d.bot_core.lcm_url; }},
};

/// Drivers of the sensors with a device in the rig.
std::vector<std::string> drivers_of(const io::Config& config) {
  std::vector<std::string> names;
  for (const KnownDriver& driver : kDriversKnown) {
    if (!driver.device(config.drivers).empty()) names.emplace_back(driver.name);
  }
  return names;
}

/// Drivers of the sensors with messages in a log.
std::set<std::string> drivers_played(const std::string& log_path) {
  constexpr std::int64_t kSurvey_us = 20'000'000;  // every sensor sends within this time
  std::set<std::string> names;
  io::LogReader log(log_path);
  std::optional<std::int64_t> end_utime;
  while (const std::optional<io::LogEvent> event = log.next()) {
    if (!end_utime) end_utime = event->timestamp_us + kSurvey_us;
    if (event->timestamp_us > *end_utime) break;
    const std::optional<bus::Channel> channel = bus::find_channel(event->channel);
    for (const KnownDriver& driver : kDriversKnown) {
      if (channel && driver.channel == channel) names.emplace(driver.name);
    }
  }
  return names;
}

/// Resolves a list of names to processes.
std::set<std::string> named(const std::vector<std::string>& names,
                            const std::vector<ChildPlan>& plans) {
  std::set<std::string> found;
  for (const std::string& name : names) {
    std::size_t before = found.size();
    std::vector<std::string> known{"drivers"};
    for (const ChildPlan& plan : plans) {
      known.push_back(plan.name.substr(std::string("orchard-").size()));
      const bool is_meant =
          name == "drivers" ? plan.stage == kDrivers : plan.name == bus::full_process_name(name);
      if (is_meant) found.insert(plan.name);
    }
    if (found.size() == before && name != "drivers") {
      const std::string near = nearest_word(name, known);
      throw io::FileError("--only or --without: this rig has no process \"" + name + "\"" +
                          (near.empty() ? "" : "; did you mean " + near + "?"));
    }
  }
  return found;
}

}  // namespace

std::vector<ChildPlan> plan_launch(const LiveOptions& options, const io::Config& config,
                                   const std::string& program_folder) {
  std::vector<ChildPlan> plans;
  const auto add = [&](const std::string& name, int stage, std::vector<std::string> more = {}) {
    ChildPlan plan;
    plan.name = name;
    plan.stage = stage;
    plan.log_path = options.out_folder + "/logs/" + name + ".log";
    plan.arguments = {program_folder + "/" + name, "--config", options.config_path};
    if (!options.lcm_url.empty()) {
      plan.arguments.insert(plan.arguments.end(), {"--lcm-url", options.lcm_url});
    }
    plan.arguments.insert(plan.arguments.end(), more.begin(), more.end());
    plans.push_back(std::move(plan));
  };
  if (!options.record_folder.empty()) {
    add("orchard-recorder", kRecorder);
    std::vector<std::string>& words = plans.back().arguments;
    words.front() = program_folder + "/orchard";
    words.insert(words.begin() + 1, "record");
    words.insert(words.end(), {"--out", options.record_folder});
  }
  add("orchard-mapper", kMapper, {"--out", options.out_folder});
  add("orchard-pose", kPose);
  add("orchard-detector", kDetector);
  if (!options.scene.empty()) {
    // A simulated drive waits until all processes listen; the drive of a real robot does not wait.
    std::string listeners;
    for (const ChildPlan& plan : plans) listeners += (listeners.empty() ? "" : ",") + plan.name;
    add("orchard-sim-driver", kDrivers,
        {"--scene", options.scene, "--seed", options.seed, "--speed", options.speed, "--hold",
         "--wait-for", listeners});
  } else if (!options.played_log.empty()) {
    for (const std::string& driver : drivers_played(options.played_log)) {
      add(driver, kDrivers, {"--emulate", options.played_log});
      plans.back().plays = true;
    }
  } else {
    for (const std::string& driver : drivers_of(config)) add(driver, kDrivers);
  }

  // The viewer only displays: no process waits for it.
  if (!options.viewer_address.empty()) {
    std::vector<std::string> words{"--listen", options.viewer_address, "--folder",
                                   options.out_folder};
    if (options.edit) words.insert(words.end(), {"--edit", options.out_folder});
    add("orchard-viewer", kRecorder, words);
  }

  const std::set<std::string> only = named(options.only, plans);
  const std::set<std::string> without = named(options.without, plans);
  const auto is_left_out = [&](const ChildPlan& plan) {
    return (!options.only.empty() && only.count(plan.name) == 0) || without.count(plan.name) > 0;
  };
  plans.erase(std::remove_if(plans.begin(), plans.end(), is_left_out), plans.end());
  if (plans.empty()) {
    throw io::FileError(options.config_path +
                        ": no process to start; name the sensors of this machine in section "
                        "drivers, or change --only and --without");
  }
  return plans;
}

}  // namespace orchard::cli
