// SPDX-License-Identifier: BSD-3-Clause
// Makes other drives of a pullally_drive recording and judges their maps: what a rig's keys are
// worth where they were not chosen.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "bus/messages/codec.hpp"
#include "bus/messages/message.hpp"
#include "evaluation/trajectory_evaluation.hpp"
#include "experiments/json_line.hpp"
#include "io/log/log_writer.hpp"
#include "io/map/map_csv.hpp"
#include "io/recording/recording_folder.hpp"
#include "system/real_recordings/altered_drive.hpp"
#include "system/real_recordings/clear_trees.hpp"
#include "system/real_recordings/tree_repeat.hpp"

namespace {

using namespace orchard;

constexpr char kUsage[] =
    "usage: altered_drive names\n"
    "       altered_drive write RECORDING_FOLDER NAME SEED OUT.lcm\n"
    "       altered_drive judge RECORDING_FOLDER NAME SEED MAP_FOLDER LASER_ONLY_MAP\n";

void write_log(const std::vector<io::SensorMessage>& messages, const std::string& path) {
  io::LogWriter writer(path);
  for (const io::SensorMessage& sensed : messages) {
    const auto message = std::visit([](const auto& m) { return bus::Message(m); }, sensed);
    writer.write(bus::utime_of(message), bus::info(bus::channel_of(message)).name,
                 bus::encode(message));
  }
  writer.close();
}

/// A map laid upon the track by its path, and how well the path fits there.
struct LaidMap {
  test::MappedDrive drive;
  double rmse_m = 0.0;
};

LaidMap read_laid(const std::string& folder, const test::AlteredDrive& altered) {
  LaidMap laid{
      {io::read_map_csv(folder + "/map.csv"), io::read_trajectory_csv(folder + "/trajectory.csv")}};
  evaluation::Track truth, estimate;
  for (const test::Station& s : altered) {
    truth.poses.push_back({s.track.utime, s.track.x_m, s.track.y_m, s.track.yaw_rad});
  }
  for (const pose::PoseEstimate& p : laid.drive.trajectory) {
    estimate.poses.push_back({p.utime, p.x_m, p.y_m, p.yaw_rad});
  }
  evaluation::TrajectoryRules rules;
  rules.alignment = evaluation::Alignment::kRigid;
  const auto evaluated = evaluation::evaluate_trajectory(estimate, truth, rules);
  laid.rmse_m = evaluated.position_m.rmse;
  const geometry::Pose2& T = evaluated.T_truth_estimate;
  const auto lay = [&T](auto& thing) {
    const Eigen::Vector2d p = transform(T, {thing.x_m, thing.y_m});
    thing.x_m = p.x();
    thing.y_m = p.y();
  };
  for (mapping::Landmark& landmark : laid.drive.map) lay(landmark);
  for (pose::PoseEstimate& pose : laid.drive.trajectory) {
    lay(pose);
    pose.yaw_rad += T.yaw_rad;
  }
  return laid;
}

/// Rows of the map with three of the clear trees or more.
int num_rows(const std::vector<test::ClearTree>& clear_trees, const test::MappedDrive& drive) {
  constexpr int kTreesMin = 3;
  std::map<int, int> trees_of;
  for (const test::ClearTree& tree : clear_trees) {
    for (const mapping::Landmark& landmark : drive.map) {
      const test::ClearTree at{landmark.x_m, landmark.y_m, 0.0};
      if (landmark.row > 0 && test::is_same_place(tree, at)) ++trees_of[landmark.row];
    }
  }
  int num = 0;
  for (const auto& [row, num_trees] : trees_of) num += num_trees >= kTreesMin ? 1 : 0;
  return num;
}

void judge(const test::AlteredDrive& altered, const test::Alteration& alteration,
           const std::string& map, const std::string& laser_map) {
  const auto recording = test::tracked_messages_of(altered);
  const auto trees = test::find_clear_trees(recording, alteration.fraction);
  const LaidMap laid = read_laid(map, altered), alone = read_laid(laser_map, altered);
  const auto found = test::compare(trees, laid.drive.map, alteration.fraction);
  const auto alone_found = test::compare(trees, alone.drive.map, alteration.fraction);
  const auto scatter = test::tree_scatter(recording, laid.drive, trees);
  trials::print_json({{"name", alteration.name},
                      {"scans", altered.size()},
                      {"clear", trees.size()},
                      {"once", found.num_with(1)},
                      {"twice", found.num_doubled()},
                      {"scatter_m", scatter.median_m()},
                      {"rows", num_rows(trees, laid.drive)},
                      {"rmse_m", laid.rmse_m},
                      {"once_alone", alone_found.num_with(1)},
                      {"twice_alone", alone_found.num_doubled()},
                      {"rmse_alone_m", alone.rmse_m}});
}

int run(const std::vector<std::string>& words) {
  if (words.size() == 1 && words[0] == "names") {
    for (const test::Alteration& a : test::alterations()) std::printf("%-15s %s\n", a.name, a.what);
    return 0;
  }
  const bool is_write = words.size() == 5 && words[0] == "write";
  const bool is_judge = words.size() == 6 && words[0] == "judge";
  if (!is_write && !is_judge) {
    std::fputs(kUsage, stderr);
    return 2;
  }
  const auto seed = static_cast<std::uint64_t>(std::strtoull(words[3].c_str(), nullptr, 10));
  const test::Alteration* alteration = test::find_alteration(words[2]);
  if (alteration == nullptr) {
    std::fprintf(stderr,
                 "altered_drive: there is no alteration of the name %s: see "
                 "altered_drive names\n",
                 words[2].c_str());
    return 2;
  }
  const auto altered = test::alter(io::read_recording_folder(words[1]), *alteration, seed);
  if (altered.empty()) {
    std::fprintf(stderr, "altered_drive: %s has no scans with a pose\n", words[1].c_str());
    return 3;
  }
  if (is_write) {
    write_log(test::messages_of(altered), words[4]);
  } else {
    judge(altered, *alteration, words[4], words[5]);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "altered_drive: %s\n", error.what());
    return 3;
  }
}
