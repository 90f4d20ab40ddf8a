// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/trajectory_csv.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/angles.hpp"
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
      csv.fail(0, "the time must increase from line to line");
    }
    pose.seq = static_cast<std::int32_t>(trajectory.size());
    pose.x_m = csv.number_in(1, -kMaxCoordinate_m, kMaxCoordinate_m);
    pose.y_m = csv.number_in(2, -kMaxCoordinate_m, kMaxCoordinate_m);
    pose.yaw_rad = geometry::wrap_angle_rad(csv.number_in(3, -kMaxYaw_rad, kMaxYaw_rad));
    trajectory.push_back(pose);
  }
  return trajectory;
}

constexpr std::size_t kPosesPerPiece = 4096;

/// The head, and then the lines of so many poses at a time.
TextPieces pieces_of(const std::vector<pose::PoseEstimate>& trajectory, const char* head,
                     std::string (*line_of)(const pose::PoseEstimate&)) {
  return
      [&trajectory, head, line_of, i = std::size_t{0}, begun = false](std::string& piece) mutable {
        piece = std::exchange(begun, true) ? "" : head;
        const std::size_t end = std::min(i + kPosesPerPiece, trajectory.size());
        for (; i < end; ++i) piece += line_of(trajectory[i]);
        return !piece.empty();
      };
}

std::string csv_line(const pose::PoseEstimate& pose) {
  return std::to_string(pose.utime) + "," + fixed_text(pose.x_m, 4) + "," +
         fixed_text(pose.y_m, 4) + "," + fixed_text(pose.yaw_rad, 5) + "\n";
}

std::string tum_line(const pose::PoseEstimate& pose) {
  const std::string micros = std::to_string(1'000'000 + pose.utime % 1'000'000).substr(1);
  return std::to_string(pose.utime / 1'000'000) + "." + micros + " " + fixed_text(pose.x_m, 4) +
         " " + fixed_text(pose.y_m, 4) + " 0 0 0 " + fixed_text(std::sin(pose.yaw_rad / 2), 7) +
         " " + fixed_text(std::cos(pose.yaw_rad / 2), 7) + "\n";
}

}  // namespace

TextPieces trajectory_csv_pieces(const std::vector<pose::PoseEstimate>& trajectory) {
  return pieces_of(trajectory, "utime_us,x_m,y_m,yaw_rad\n", csv_line);
}

TextPieces trajectory_tum_pieces(const std::vector<pose::PoseEstimate>& trajectory) {
  return pieces_of(trajectory, "# seconds x y z qx qy qz qw\n", tum_line);
}

std::string trajectory_csv(const std::vector<pose::PoseEstimate>& trajectory) {
  std::string text, piece;
  for (const TextPieces next = trajectory_csv_pieces(trajectory); next(piece);) text += piece;
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
