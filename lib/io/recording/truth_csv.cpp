// SPDX-License-Identifier: BSD-3-Clause
#include "io/recording/truth_csv.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "geometry/angles.hpp"
#include "io/atomic_file.hpp"
#include "io/csv.hpp"
#include "io/file_error.hpp"
#include "io/map/map_csv.hpp"
#include "io/sane_limits.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

using detection::Label;
using simulation::TruthObject;

std::optional<std::size_t> find_column(const CsvReader& csv, const char* name) {
  const auto& columns = csv.columns();
  const auto found = std::find(columns.begin(), columns.end(), name);
  if (found == columns.end()) return std::nullopt;
  return static_cast<std::size_t>(found - columns.begin());
}

void write_spatial_poses(const std::string& path, const std::vector<simulation::TruePose>& poses) {
  std::string text = "utime_us,x_m,y_m,yaw_rad,z_m,roll_rad,pitch_rad\n";
  for (const simulation::TruePose& pose : poses) {
    text += std::to_string(pose.utime) + "," + fixed_text(pose.x_m, 4) + "," +
            fixed_text(pose.y_m, 4) + "," + fixed_text(pose.yaw_rad, 5) + "," +
            fixed_text(pose.z_m, 4) + "," + fixed_text(pose.roll_rad, 5) + "," +
            fixed_text(pose.pitch_rad, 5) + "\n";
  }
  write_file_atomically(path, text);
}

}  // namespace

std::vector<TruthObject> read_truth_csv(const std::string& path) {
  CsvReader csv = CsvReader::open(path);
  std::vector<std::string> columns{"class", "x_m", "y_m", "width_m"};
  const bool has_heights = csv.columns().size() > columns.size();
  if (has_heights) columns.push_back("z_m");
  csv.expect_columns(columns);
  std::vector<TruthObject> truth;
  int num_trees = 0;
  int num_objects = 0;
  while (csv.next()) {
    TruthObject object;
    if (csv.text(0) == "tree") {
      object.label = Label::kTree;
      object.name = "T" + std::to_string(++num_trees);
    } else if (csv.text(0) == "object") {
      object.label = Label::kObject;
      object.name = "B" + std::to_string(++num_objects);
    } else {
      csv.fail(0, "must be tree or object");
    }
    object.x_m = csv.number_in(1, -kMaxCoordinate_m, kMaxCoordinate_m);
    object.y_m = csv.number_in(2, -kMaxCoordinate_m, kMaxCoordinate_m);
    object.width_m = csv.number_in(3, 0.0, kMaxWidth_m);
    object.z_m = has_heights ? csv.number_in(4, -kMaxCoordinate_m, kMaxCoordinate_m)
                             : std::numeric_limits<double>::quiet_NaN();
    truth.push_back(object);
  }
  return truth;
}

void write_truth_csv(const std::string& path, const std::vector<TruthObject>& truth,
                     Heights heights) {
  const bool with_heights = heights == Heights::kWritten;
  std::string text = with_heights ? "class,x_m,y_m,width_m,z_m\n" : "class,x_m,y_m,width_m\n";
  for (const TruthObject& object : truth) {
    if (object.label == Label::kUnseen)
      throw FileError(path + ": an object of the truth must not be unseen");
    text += object.label == Label::kTree ? "tree," : "object,";
    text += fixed_text(object.x_m, 4) + "," + fixed_text(object.y_m, 4) + "," +
            fixed_text(object.width_m, 4);
    text += with_heights ? "," + fixed_text(object.z_m, 4) + "\n" : "\n";
  }
  write_file_atomically(path, text);
}

void write_poses_csv(const std::string& path, const std::vector<simulation::TruePose>& poses,
                     Heights heights) {
  if (heights == Heights::kWritten) return write_spatial_poses(path, poses);
  std::vector<pose::PoseEstimate> trajectory(poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    trajectory[i].utime = poses[i].utime;
    trajectory[i].x_m = poses[i].x_m;
    trajectory[i].y_m = poses[i].y_m;
    trajectory[i].yaw_rad = poses[i].yaw_rad;
  }
  write_trajectory_csv(path, trajectory);
}

evaluation::Track read_track_csv(const std::string& path) {
  CsvReader csv = CsvReader::open(path);
  const auto utime = find_column(csv, "utime_us");
  const auto x = find_column(csv, "x_m"), y = find_column(csv, "y_m");
  const auto yaw = find_column(csv, "yaw_rad");
  if (!utime || !x || !y) {
    throw FileError(path +
                    ":1: a track needs the columns utime_us, x_m and y_m (optionally yaw_rad), "
                    "like trajectory.csv and poses.csv");
  }
  evaluation::Track track;
  track.has_yaw = yaw.has_value();
  while (csv.next()) {
    evaluation::TrackPose pose;
    pose.utime = csv.later_utime(*utime, track.poses.empty() ? -1 : track.poses.back().utime);
    pose.x_m = csv.number_in(*x, -kMaxCoordinate_m, kMaxCoordinate_m);
    pose.y_m = csv.number_in(*y, -kMaxCoordinate_m, kMaxCoordinate_m);
    if (yaw)
      pose.yaw_rad = geometry::wrap_angle_rad(csv.number_in(*yaw, -kMaxYaw_rad, kMaxYaw_rad));
    track.poses.push_back(pose);
  }
  if (track.poses.empty()) throw FileError(path + ": has no poses");
  return track;
}

}  // namespace orchard::io
