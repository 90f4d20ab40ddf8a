// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/map_csv.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>
#include <utility>

#include "detection/detection.hpp"
#include "geometry/angles.hpp"
#include "io/csv.hpp"
#include "io/map/rounded.hpp"
#include "io/sane_limits.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

using detection::Label;
using mapping::Landmark;

constexpr double kMaxSizeM = 1e6;
constexpr double kLeastSdM = 1e-4;  // derived: the last digit of the file; 0 would mean unknown
constexpr std::int64_t kMaxInt = std::numeric_limits<std::int32_t>::max();

Label parse_label(const CsvReader& csv, std::size_t field) {
  for (const Label label : {Label::kTree, Label::kObject, Label::kUnseen}) {
    if (csv.text(field) == label_text(label)) return label;
  }
  csv.fail(field, "must be tree, object or unseen");
}

std::int32_t parse_number_or_empty(const CsvReader& csv, std::size_t field) {
  if (csv.text(field).empty()) return 0;
  return static_cast<std::int32_t>(csv.integer_in(field, 1, kMaxInt));
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

bool is_map(const std::string& path) {
  constexpr std::string_view kBegin = "id,class,";
  std::ifstream file(path, std::ios::binary);
  std::string begin(kBegin.size(), '\0');
  // A folder opens, but cannot be read.
  if (!file.read(begin.data(), static_cast<std::streamsize>(begin.size()))) {
    return !file.is_open() || std::filesystem::is_directory(path);
  }
  return begin == kBegin || begin.rfind("\x1f\x8b", 0) == 0;
}

std::string map_csv(const std::vector<Landmark>& landmarks) {
  std::string text =
      "id,class,x_m,y_m,n,roc_mean,probability,se_x_m,se_y_m,width_m,row,position,"
      "width_sd_m,length_m,direction_deg,z_m,z_sd_m\n";
  for (const Landmark& l : landmarks) {
    text +=
        std::to_string(l.id) + "," + label_text(l.label) + "," + fixed_text(l.x_m, 4) + "," +
        fixed_text(l.y_m, 4) + "," + std::to_string(l.num_observations) + "," +
        fixed_text(l.roc_mean, 4) + "," + fixed_text(l.probability, 4) + "," +
        fixed_text(l.se_x_m, 4) + "," + fixed_text(l.se_y_m, 4) + "," + fixed_text(l.width_m, 4) +
        "," + number_or_empty(l.row) + "," + number_or_empty(l.position) + "," +
        (l.width_sd_m > 0.0 ? fixed_text(l.width_sd_m, 4) : std::string()) + "," +
        (l.length_m > 0.0 ? fixed_text(l.length_m, 4) + "," +
                                fixed_text(l.direction_rad * 180.0 / geometry::kPi, 2)
                          : std::string(",")) +
        "," +
        (l.z_sd_m > 0.0 ? fixed_text(l.z_m, 4) + "," + fixed_text(std::max(l.z_sd_m, kLeastSdM), 4)
                        : std::string(",")) +
        "\n";
  }
  return text;
}

std::vector<Landmark> read_map_csv(const std::string& path) {
  CsvReader csv = CsvReader::open(path);
  std::vector<std::string> columns{"id",          "class",  "x_m",    "y_m",     "n",   "roc_mean",
                                   "probability", "se_x_m", "se_y_m", "width_m", "row", "position"};
  // files of earlier releases have fewer columns
  const bool has_width_sd = csv.columns().size() > columns.size();
  if (has_width_sd) columns.push_back("width_sd_m");
  const bool has_length = csv.columns().size() > columns.size();
  if (has_length) columns.insert(columns.end(), {"length_m", "direction_deg"});
  const bool has_height = csv.columns().size() > columns.size();
  if (has_height) columns.insert(columns.end(), {"z_m", "z_sd_m"});
  csv.expect_columns(columns);
  std::vector<Landmark> landmarks;
  std::set<std::int32_t> ids;
  while (csv.next()) {
    Landmark landmark;
    landmark.id = static_cast<std::int32_t>(csv.integer_in(0, 0, kMaxInt));
    if (!ids.insert(landmark.id).second) csv.fail(0, "this id occurs twice");
    landmark.label = parse_label(csv, 1);
    landmark.x_m = csv.number_in(2, -kMaxCoordinate_m, kMaxCoordinate_m);
    landmark.y_m = csv.number_in(3, -kMaxCoordinate_m, kMaxCoordinate_m);
    landmark.num_observations = static_cast<std::int32_t>(csv.integer_in(4, 0, kMaxInt));
    landmark.roc_mean = csv.number_in(5, 0.0, 1.0);
    landmark.probability = csv.number_in(6, 0.0, 1.0);
    landmark.se_x_m = csv.number_in(7, 0.0, kMaxSizeM);
    landmark.se_y_m = csv.number_in(8, 0.0, kMaxSizeM);
    landmark.width_m = csv.number_in(9, 0.0, kMaxSizeM);
    landmark.row = parse_number_or_empty(csv, 10);
    landmark.position = parse_number_or_empty(csv, 11);
    if (has_width_sd && !csv.text(12).empty()) {
      landmark.width_sd_m = csv.number_in(12, 0.0, kMaxSizeM);
    }
    if (has_length && !csv.text(13).empty()) {
      landmark.length_m = csv.number_in(13, 0.0, kMaxSizeM);
      landmark.direction_rad = csv.number_in(14, -180.0, 180.0) * geometry::kPi / 180.0;
    }
    if (has_height && !(csv.text(15).empty() && csv.text(16).empty())) {
      landmark.z_m = csv.number_in(15, -kMaxSizeM, kMaxSizeM);
      landmark.z_sd_m = csv.number_in(16, kLeastSdM, kMaxSizeM);
    }
    landmarks.push_back(landmark);
  }
  return landmarks;
}

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
  TimedCsv<pose::PoseEstimate> table(CsvReader::open(path), pose_columns<pose::PoseEstimate>());
  std::vector<pose::PoseEstimate> trajectory;
  while (const auto pose = table.next()) trajectory.push_back(*pose);
  return trajectory;
}

}  // namespace orchard::io
