// SPDX-License-Identifier: BSD-3-Clause
#include "cli/rig/learn.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <optional>
#include <set>
#include <sstream>
#include <utility>
#include <variant>

#include "bus/messages/channel.hpp"
#include "bus/messages/codec.hpp"
#include "bus/process/process.hpp"
#include "bus/replay/in_process_replay.hpp"
#include "detector/detector_node.hpp"
#include "geometry/angles.hpp"
#include "io/atomic_file.hpp"
#include "io/config/config_edit.hpp"
#include "io/file_error.hpp"
#include "io/progress_bar.hpp"
#include "mapper/mapper_node.hpp"
#include "mapping/finish/trunk_width.hpp"
#include "pose/pose_node.hpp"
#include "text/number_text.hpp"

namespace orchard::cli {
namespace {

using bus::Channel;

/// derived: before anything is known of the trunks: those of most plantings, from vine to old tree.
constexpr double kAnyWidth_m = 0.15;
constexpr double kAnyWidthSd_m = 0.10;
/// physical: field scanners' data sheets state 1 to 3 cm.
constexpr double kAnyNoise_m = 0.01;
/// physical: fewer beams tell neither width nor place.
constexpr double kBeamsOnTrunk = 2.0;
/// derived: a value is written if it is known better than this; else a person is asked.
constexpr double kMountSdMax_m = 0.03;
constexpr double kYawSdMax_rad = 0.015;
constexpr double kAntennaSdMax_m = 0.10;

/// The comment of a value that the drive did not show.
/// derived: all but one in twenty: the wheels alone bridge the others.
constexpr double kDetermined = 0.95;
constexpr const char* kNotSeen = "not seen; as given, or a guess to be replaced";

/// What a log holds.
struct Survey {
  std::set<Channel> channels;
  std::optional<laser::Scan> scan;  ///< the first
  bool fixes_have_yaw = false;

  bool has(Channel channel) const { return channels.count(channel) > 0; }
};

Survey survey_of(const io::LogPaths& logs) {
  Survey survey;
  io::LogSeries reader(logs);
  while (const auto event = reader.next()) {
    const std::optional<Channel> channel = bus::find_channel(event->channel);
    if (!channel) continue;
    const bool is_first = survey.channels.insert(*channel).second;
    if (!is_first || (*channel != Channel::kScan && *channel != Channel::kPoseFix)) continue;
    const auto decoded = bus::decode(*channel, event->data.data(), event->data.size());
    const auto* message = std::get_if<bus::Message>(&decoded);
    if (message == nullptr) {
      survey.channels.erase(*channel);  // damaged: the next one may tell
    } else if (const auto* scan = std::get_if<laser::Scan>(message)) {
      survey.scan = *scan;
    } else if (const auto* fix = std::get_if<pose::PoseFix>(message)) {
      survey.fixes_have_yaw = fix->has_yaw;
    }
  }
  if (!survey.scan) {
    throw io::FileError(logs.text() +
                        " has no valid SCAN message; a rig is learnt from the scans of its laser "
                        "(`orchard log info` lists the channels)");
  }
  return survey;
}

/// The YAML of a rig that grows, value by value.
class RigText {
 public:
  explicit RigText(std::string yaml) : yaml_(std::move(yaml)) {}

  void set(const std::vector<io::ConfigValue>& values, const std::string& note) {
    yaml_ = io::edit_config(yaml_, "the learnt rig", values, "learnt", note);
  }
  const std::string& yaml() const { return yaml_; }
  io::Config config() const { return io::parse_config(yaml_, "the learnt rig"); }

 private:
  std::string yaml_;
};

/// The mode that uses what the log holds.
std::vector<io::ConfigValue> pose_values(const Survey& survey) {
  if (survey.fixes_have_yaw) {
    return {{"pose.mode", survey.has(Channel::kOdometry) ? "fixes_and_odometry" : "fixes"}};
  }
  if (survey.has(Channel::kOdometry) && survey.has(Channel::kGnss)) {
    return {{"pose.mode", "slam"}, {"pose.slam.use_gnss", "true"}};
  }
  if (survey.has(Channel::kOdometry)) return {{"pose.mode", "slam"}};
  return {{"pose.mode", "slam"}, {"pose.motion", "scans"}};
}

/// A trunk of this width gets two beams up to this range [m].
double reach_m(const laser::Scan& scan, double width_m) {
  const double reach = width_m / (kBeamsOnTrunk * std::abs(scan.bearing_step_rad));
  const double most = scan.range_max_m > 0.0 ? scan.range_max_m : 100.0;
  return std::floor(10.0 * std::min(reach, most)) / 10.0;
}

struct Drive {
  std::vector<mapping::Landmark> landmarks;
  pose::RigEstimates rig;
  std::optional<double> noise_ratio;
  std::optional<laser::OwnReturn> own_returns;
};

Drive mapped(const char* command, const io::LogPaths& logs, const io::Config& config,
             const std::string& what, bool quiet) {
  procs::DetectorNode detector(config);
  procs::PoseNode pose(config);
  procs::MapperNode mapper(config);
  mapper.set_has_readers(false);
  io::ProgressBar bar(what, !quiet);
  bus::ReplayOptions replay;
  replay.num_jobs = 0;
  replay.progress = [&](std::uint64_t done, std::uint64_t total) { bar.update(done, total); };
  const bus::ReplayReport report =
      bus::replay_in_process(logs, {&detector, &pose, &mapper}, replay);
  bar.finish();
  for (const std::string& warning : report.warnings) {
    std::fprintf(stderr, "%s: warning: %s\n", command, warning.c_str());
  }
  return {mapper.finished_landmarks(), pose.rig_estimates(), detector.range_noise_ratio(),
          detector.own_returns()};
}

std::string number(double value) { return fixed_text(value, 3); }

std::string pair_text(double a, double b) { return "[" + number(a) + ", " + number(b) + "]"; }

class Learner {
 public:
  Learner(const char* command, const io::LogPaths& logs, const std::string& base, bool quiet)
      : command_(command),
        logs_(logs),
        quiet_(quiet),
        is_given_(!base.empty()),
        survey_(survey_of(logs)),
        rig_(base),
        before_(rig_.config()) {}

  LearntRig learnt() {
    const bool has_camera = before_.camera.enabled && survey_.has(Channel::kImage) &&
                            rig_.yaml().find("fc_px") != std::string::npos;
    start(has_camera);
    const Drive first = mapped(command_, logs_, rig_.config(), "first look", quiet_);
    learn_motion(first);
    learn_place(first);
    learn_noise(first);
    learn_own_returns(first);
    // Trunks are still of any width: which of them are seen must not depend on what was found.
    learn_width(mapped(command_, logs_, rig_.config(), "second look", quiet_));
    if (survey_.has(Channel::kImage) && !has_camera) {
      ask("the camera is left out: calibrate it (orchard calibrate camera, laser-camera) and set "
          "camera.enabled: true");
    }
    result_.yaml = rig_.yaml();
    result_.config = rig_.config();
    return std::move(result_);
  }

 private:
  void tell(const std::vector<io::ConfigValue>& values, const std::string& how) {
    rig_.set(values, how);
    std::string line;
    for (const io::ConfigValue& v : values)
      line += (line.empty() ? "" : ", ") + v.key + ": " + v.value;
    result_.seen.push_back(line + "  (" + how + ")");
  }
  void ask(const std::string& what) { result_.asked.push_back(what); }

  /// Before the first look: what the log holds, and values by which trunks of any width and scans
  /// of any noise are seen.
  void start(bool has_camera) {
    if (!has_camera) rig_.set({{"camera.enabled", "false"}}, "");
    if (!is_given_) start_without_rig(has_camera);
    if (survey_.has(Channel::kScanRear) && !before_.laser_rear.enabled) {
      ask("SCAN.rear is left out: set laser_rear.enabled: true and its mount");
    }
    rig_.set({{"laser.range_sd_m", number(kAnyNoise_m)}, {"laser.range_sd_fraction", "0.0"}}, "");
    rig_.set({{"detector.width.mean_m", number(kAnyWidth_m)},
              {"detector.width.sd_m", number(kAnyWidthSd_m)}},
             "");
    rig_.set({{"detector.segmentation.range_max_m", number(reach_m(*survey_.scan, kAnyWidth_m))}},
             "");
  }

  /// What a rig that is given decides itself.
  void start_without_rig(bool has_camera) {
    std::string channels;
    for (const Channel channel : {Channel::kOdometry, Channel::kPoseFix, Channel::kGnss}) {
      if (!survey_.has(channel)) continue;
      channels += (channels.empty() ? "" : ", ") + std::string(bus::info(channel).name);
    }
    tell(pose_values(survey_), channels.empty() ? "the log holds SCAN alone: they tell the motion"
                                                : "the log has " + channels);
    if (!has_camera) rig_.set({{"detector.tree_threshold", "0.2"}}, "by the laser alone");
    rig_.set({{"mapper.min_observations", "5"}}, "fewer views are twigs and people");
  }

  /// Scans tell the motion better than wheels, which slip, where they determine it.
  void learn_motion(const Drive& drive) {
    if (is_given_ || rig_.config().pose.mode != pose::PoseMode::kSlam || !drive.rig.by_wheels)
      return;
    if (drive.rig.scans_determined < kDetermined) return;
    tell({{"pose.motion", "scans"}}, fmt::format("{:.0f} % of the motions are seen by the scanner",
                                                 100.0 * drive.rig.scans_determined));
  }

  void learn_place(const Drive& drive) {
    const auto& seen = drive.rig.laser;
    const std::string by = seen ? fmt::format("by {} motions of SCAN and {}", seen->num_pairs,
                                              drive.rig.by_wheels ? "the wheels" : "the fixes")
                                : "";
    if (seen && seen->is_mirrored) {
      ask("the scans turn the other way than " +
          std::string(drive.rig.by_wheels ? "the wheels" : "the fixes") +
          ": first find out which of the two is a mirror image (a scanner upside down?)");
      return;
    }
    if (seen && seen->mount_yaw_rad.sd < kYawSdMax_rad) {
      tell({{"laser.mount_yaw_rad", number(seen->mount_yaw_rad.value)}},
           fmt::format("+- {:.3f}, {}", seen->mount_yaw_rad.sd, by));
    } else {
      ask("laser.mount_yaw_rad: the direction in which the scanner looks (0: ahead)");
    }
    if (seen && seen->mount_x_m.sd < kMountSdMax_m && seen->mount_y_m.sd < kMountSdMax_m) {
      tell({{"laser.mount_x_m", number(seen->mount_x_m.value)},
            {"laser.mount_y_m", number(seen->mount_y_m.value)}},
           fmt::format("+- {:.3f}, {:.3f}, {}", seen->mount_x_m.sd, seen->mount_y_m.sd, by));
    } else {
      ask("laser.mount_x_m, mount_y_m: where the scanner sits on the robot, by a ruler" +
          std::string(seen ? " (the drive turns too little to tell)" : ""));
    }
    learn_antenna(drive.rig);
  }

  void learn_antenna(const pose::RigEstimates& rig) {
    if (!survey_.has(Channel::kGnss)) return;
    const io::Config config = rig_.config();
    if (rig.antenna && std::sqrt(rig.antenna->covariance.trace()) < kAntennaSdMax_m) {
      const Eigen::Vector2d p_base_m =
          geometry::transform(Eigen::Vector3d(config.laser.mount_x_m, config.laser.mount_y_m,
                                              config.laser.mount_yaw_rad),
                              rig.antenna->p_laser_m);
      tell({{"pose.gnss.antenna_m", pair_text(p_base_m.x(), p_base_m.y())}},
           fmt::format("+- {:.3f}, by {} fixes in turns",
                       std::sqrt(rig.antenna->covariance.trace()), rig.antenna->num_fixes));
    } else {
      ask("pose.gnss.antenna_m: where the antenna is on the robot, by a ruler");
    }
  }

  void learn_noise(const Drive& drive) {
    if (!drive.noise_ratio) {
      if (is_given_) {
        rig_.set({{"laser.range_sd_m", shortest_text(before_.laser.range_sd_m)},
                  {"laser.range_sd_fraction", shortest_text(before_.laser.range_sd_fraction)}},
                 "");
      }
      rig_.set({{"laser.range_sd_m", shortest_text(rig_.config().laser.range_sd_m)}}, kNotSeen);
      ask("laser.range_sd_m: the noise of a range, from the data sheet (no smooth surface is large "
          "enough to tell)");
      return;
    }
    // A surface's own roughness and what the beams share are not in it; a data sheet's figure is
    // larger, so the measured one is a lower limit.
    const double sd_m = *drive.noise_ratio * kAnyNoise_m;
    tell({{"laser.range_sd_m", number(std::max(sd_m, kAnyNoise_m))}},
         fmt::format("{:.3f} m on smooth surfaces, and bark", sd_m));
  }

  void learn_own_returns(const Drive& drive) {
    if (!drive.own_returns) return;
    const laser::OwnReturn& own = *drive.own_returns;
    tell({{"detector.segmentation.blind_centre_rad", number(own.sector.centre_rad)},
          {"detector.segmentation.blind_half_width_rad", number(own.sector.half_width_rad)}},
         fmt::format("returns nearer than {:.1f} m travel along", own.reach_m));
  }

  void learn_width(const Drive& drive) {
    const auto width = mapping::trunk_width_of(drive.landmarks);
    if (!width) {
      if (is_given_) {
        rig_.set({{"detector.width.mean_m", shortest_text(before_.detector.width.mean_m)},
                  {"detector.width.sd_m", shortest_text(before_.detector.width.sd_m)},
                  {"detector.segmentation.range_max_m",
                   shortest_text(before_.detector.segmentation.range_max_m)}},
                 "");
      }
      rig_.set({{"detector.width.mean_m", shortest_text(rig_.config().detector.width.mean_m)}},
               kNotSeen);
      ask("detector.width.mean_m, sd_m: the width of the trunks at the height of the scanner, by a "
          "calliper (too few are alike to tell)");
      return;
    }
    tell({{"detector.width.mean_m", number(width->mean_m)},
          {"detector.width.sd_m", number(std::max(width->sd_m, 0.1 * width->mean_m))}},
         fmt::format("+- {:.3f}, {} things are alike", width->mean_se_m, width->num_trunks));
    tell({{"detector.segmentation.range_max_m", number(reach_m(*survey_.scan, width->mean_m))}},
         "up to there a trunk has two beams");
  }

  const char* command_;
  const io::LogPaths& logs_;
  bool quiet_;
  bool is_given_;  ///< a rig to complete: what is not seen of it stays
  Survey survey_;
  RigText rig_;
  io::Config before_;
  LearntRig result_;
};

std::string text_of(const std::string& path) {
  if (path.empty()) return {};
  io::load_config(path);  // errors name the file
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

LearntRig learn_rig(const char* command, const io::LogPaths& logs, const std::string& base,
                    bool quiet) {
  return Learner(command, logs, base, quiet).learnt();
}

int run_learn(const LearnOptions& options) {
  const io::LogPaths logs{options.log_paths};
  const LearntRig rig =
      learn_rig("orchard learn", logs, text_of(options.config_path), options.quiet);
  io::write_file_atomically(options.out_path, rig.yaml);
  if (options.quiet) return bus::kExitOk;
  for (const std::string& line : rig.seen) std::printf("%s\n", line.c_str());
  for (const std::string& line : rig.asked) std::printf("not seen: %s\n", line.c_str());
  std::printf("written to %s; next: orchard map %s --config %s --out out/map\n",
              options.out_path.c_str(), options.log_paths.front().c_str(),
              options.out_path.c_str());
  return bus::kExitOk;
}

}  // namespace orchard::cli
