// SPDX-License-Identifier: BSD-3-Clause
#include "io/recording/track_csv.hpp"

#include <algorithm>
#include <optional>

#include "geometry/angles.hpp"
#include "io/csv.hpp"
#include "io/file_error.hpp"
#include "io/sane_limits.hpp"

namespace orchard::io {
namespace {

std::optional<std::size_t> find_column(const CsvReader& csv, const char* name) {
  const auto& columns = csv.columns();
  const auto found = std::find(columns.begin(), columns.end(), name);
  if (found == columns.end()) return std::nullopt;
  return static_cast<std::size_t>(found - columns.begin());
}

evaluation::Track read_track(CsvReader csv, const std::string& name) {
  const auto utime = find_column(csv, "utime_us");
  const auto x = find_column(csv, "x_m"), y = find_column(csv, "y_m");
  const auto yaw = find_column(csv, "yaw_rad");
  if (!utime || !x || !y) {
    throw FileError(name +
                    ":1: a track needs the columns utime_us, x_m and y_m (optionally yaw_rad), "
                    "like trajectory.csv and poses.csv");
  }
  evaluation::Track track;
  track.has_yaw = yaw.has_value();
  while (csv.next()) {
    evaluation::TrackPose pose;
    pose.utime = csv.integer(*utime);
    if (!track.poses.empty() && pose.utime <= track.poses.back().utime) {
      csv.fail(*utime, "the time must increase from line to line");
    }
    pose.x_m = csv.number_in(*x, -kMaxCoordinate_m, kMaxCoordinate_m);
    pose.y_m = csv.number_in(*y, -kMaxCoordinate_m, kMaxCoordinate_m);
    if (yaw)
      pose.yaw_rad = geometry::wrap_angle_rad(csv.number_in(*yaw, -kMaxYaw_rad, kMaxYaw_rad));
    track.poses.push_back(pose);
  }
  if (track.poses.empty()) throw FileError(name + ": has no poses");
  return track;
}

}  // namespace

evaluation::Track read_track_csv(const std::string& path) {
  return read_track(CsvReader::open(path), path);
}

}  // namespace orchard::io
