// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/trajectory_csv.hpp"

#include <cmath>

#include "geometry/angles.hpp"
#include "io/atomic_file.hpp"
#include "io/csv.hpp"
#include "io/sane_limits.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

std::vector<pose::PoseEstimate> read_trajectory(CsvReader csv) {
  csv.expect_columns({"utime_us", "x_m", "y_m", "yaw_rad"});
  std::vector<pose::PoseEstimate> trajectory;
  while (csv.next()) {
    pose::PoseEstimate pose;
    pose.utime = csv.integer(0);
    if (!trajectory.empty() && pose.utime <= trajectory.back().utime) {
      csv.fail(0, "time must go up from line to line");
    }
    pose.seq = static_cast<std::int32_t>(trajectory.size());
    pose.x_m = csv.number_in(1, -kMaxCoordinate_m, kMaxCoordinate_m);
    pose.y_m = csv.number_in(2, -kMaxCoordinate_m, kMaxCoordinate_m);
    pose.yaw_rad = geometry::wrap_angle_rad(csv.number_in(3, -kMaxYaw_rad, kMaxYaw_rad));
    trajectory.push_back(pose);
  }
  return trajectory;
}

}  // namespace

std::string trajectory_csv(const std::vector<pose::PoseEstimate>& trajectory) {
  std::string text = "utime_us,x_m,y_m,yaw_rad\n";
  for (const pose::PoseEstimate& pose : trajectory) {
    text += std::to_string(pose.utime) + "," + fixed_text(pose.x_m, 4) + "," +
            fixed_text(pose.y_m, 4) + "," + fixed_text(pose.yaw_rad, 5) + "\n";
  }
  return text;
}

std::string trajectory_tum(const std::vector<pose::PoseEstimate>& trajectory) {
  std::string text = "# seconds x y z qx qy qz qw\n";
  for (const pose::PoseEstimate& pose : trajectory) {
    const std::string micros = std::to_string(1'000'000 + pose.utime % 1'000'000).substr(1);
    text += std::to_string(pose.utime / 1'000'000) + "." + micros + " " + fixed_text(pose.x_m, 4) +
            " " + fixed_text(pose.y_m, 4) + " 0 0 0 " + fixed_text(std::sin(pose.yaw_rad / 2), 7) +
            " " + fixed_text(std::cos(pose.yaw_rad / 2), 7) + "\n";
  }
  return text;
}

void write_trajectory_csv(const std::string& path,
                          const std::vector<pose::PoseEstimate>& trajectory) {
  write_file_atomically(path, trajectory_csv(trajectory));
}

std::vector<pose::PoseEstimate> read_trajectory_csv(const std::string& path) {
  return read_trajectory(CsvReader::open(path));
}

std::vector<pose::PoseEstimate> parse_trajectory_csv(std::string_view text,
                                                     const std::string& name) {
  return read_trajectory(CsvReader::from_text(text, name));
}

}  // namespace orchard::io
