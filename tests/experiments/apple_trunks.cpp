// SPDX-License-Identifier: BSD-3-Clause
// Diameters of trunks by range, by picture and by both, from lines of a depth camera taken for the
// scans of a laser that looks through the camera's centre. Which segments are the trunk is told by
// range alone: those along one straight line through all scans of a picture.
// apple_trunks ROWS.csv IMAGES RIG [MASKS]   (MASKS: a folder for pictures of where the trunks are)
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "detection/detect.hpp"
#include "detection/picture_width.hpp"
#include "experiments/json_line.hpp"
#include "geometry/angles.hpp"
#include "io/config/config.hpp"
#include "io/recording/picture_file.hpp"

namespace {

using namespace orchard;

/// Depths along a row of the picture; 0 = none.
struct DepthRow {
  int row_px = 0;
  std::vector<double> depth_m;
};

using Pictures = std::map<std::string, std::vector<DepthRow>>;

/// Lines of image, image_row, first_column, column_step, depth_m of every column.
Pictures read_rows(const std::string& path) {
  Pictures pictures;
  std::ifstream file(path);
  std::string line, name, cell;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    DepthRow row;
    std::getline(cells, name, ',');
    std::getline(cells, cell, ',');
    row.row_px = std::stoi(cell);
    for (int skipped = 0; skipped < 2; ++skipped) std::getline(cells, cell, ',');
    while (std::getline(cells, cell, ',')) {
      row.depth_m.push_back(cell.empty() ? 0.0 : std::stod(cell));
    }
    if (line.back() == ',') row.depth_m.push_back(0.0);
    pictures[name].push_back(row);
  }
  return pictures;
}

/// The slope of a row's plane through the camera's centre.
double down_of(int row_px, const geometry::CameraIntrinsics& lens) {
  return (row_px - lens.cc_px[1]) / lens.fc_px[1];
}

/// The rig whose laser scans the plane of a row.
detection::Rig rig_of(int row_px, const io::Config& config) {
  geometry::CameraConfig camera = config.camera;
  const double pitch_rad = std::atan(down_of(row_px, camera.intrinsics));
  camera.extrinsics = {{}, {0.5 * geometry::kPi - pitch_rad, 0.0, 0.5 * geometry::kPi}};
  return {config.laser, camera, config.detector};
}

/// A row as a scan with a beam for each column in the middle of the picture.
laser::Scan scan_of(const DepthRow& row, const io::Config& config) {
  const geometry::CameraIntrinsics& lens = config.camera.intrinsics;
  const double out = std::hypot(1.0, down_of(row.row_px, lens));
  laser::Scan scan;
  scan.bearing_step_rad = 1.0 / (lens.fc_px[0] * out);
  const double most = std::min(lens.cc_px[0], lens.width_px - 1 - lens.cc_px[0]);
  const int half =
      static_cast<int>(std::atan(most * scan.bearing_step_rad) / scan.bearing_step_rad);
  scan.bearing_min_rad = -half * scan.bearing_step_rad;
  scan.range_max_m = config.detector.segmentation.range_max_m;
  for (int i = -half; i <= half; ++i) {
    const double left = std::tan(i * scan.bearing_step_rad) * out;
    const auto column = static_cast<std::size_t>(std::lround(lens.cc_px[0] - lens.fc_px[0] * left));
    scan.ranges_m.push_back(static_cast<float>(row.depth_m.at(column) * std::hypot(out, left)));
  }
  return scan;
}

struct Seen {
  int row_px = 0;
  laser::Segment segment;
  double angle_sd_rad = 0.0;
  detection::Detection detection;
  Eigen::Vector3d p_camera;  ///< its axis
};

std::vector<Seen> look(const DepthRow& row, const vision::Image& image, const io::Config& config) {
  const detection::Rig rig = rig_of(row.row_px, config);
  const laser::Scan scan = scan_of(row, config);
  const auto candidates = detection::find_by_laser(scan, rig).candidates;
  const auto detections = detection::detect(scan, &image, rig).detections.trunks;
  std::vector<Seen> seen;
  for (const detection::Candidate& c : candidates) {
    const double axis_m = c.segment.range_m + 0.5 * c.segment.width_m;
    const Eigen::Vector3d p_laser(axis_m * std::cos(c.segment.bearing_rad),
                                  axis_m * std::sin(c.segment.bearing_rad), 0.0);
    seen.push_back(
        {row.row_px, c.segment, c.angle_sd_rad, detections[c.index], rig.T_camera_laser(p_laser)});
  }
  return seen;
}

/// The segments along the straight line that has most of them, one of a row.
std::vector<Seen> along_a_trunk(const std::vector<Seen>& seen, const io::Config& config) {
  const double radius_m = 0.5 * config.detector.width.mean_m;
  const double lean = std::tan(config.detector.edges.max_tilt_deg * geometry::kPi / 180.0);
  std::vector<Seen> best;
  double best_score = 0.0;
  for (const Seen& a : seen) {
    for (const Seen& b : seen) {
      const Eigen::Vector3d step = (b.p_camera - a.p_camera) / (b.p_camera.y() - a.p_camera.y());
      if (a.row_px >= b.row_px || !(std::abs(step.x()) < lean)) continue;
      std::map<int, std::pair<double, const Seen*>> nearest;
      for (const Seen& c : seen) {
        const double down_m = c.p_camera.y() - a.p_camera.y();
        const double off = (c.p_camera - a.p_camera - down_m * step).norm() / radius_m;
        const auto [at, is_new] = nearest.emplace(c.row_px, std::pair{off, &c});
        if (!is_new && off < at->second.first) at->second = {off, &c};
      }
      double score = 0.0;
      for (const auto& [row_px, near] : nearest) score += std::max(0.0, 1.0 - near.first);
      if (score <= best_score) continue;
      best_score = score;
      best.clear();
      for (const auto& [row_px, near] : nearest) {
        if (near.first < 1.0) best.push_back(*near.second);
      }
    }
  }
  return best;
}

/// Red between the sides of the trunk, from row to next row.
void write_mask(const std::vector<Seen>& trunk, const io::Config& config, int rows_apart_px,
                const std::string& path) {
  const geometry::CameraIntrinsics& lens = config.camera.intrinsics;
  cv::Mat mask(lens.height_px, lens.width_px, CV_8UC3, cv::Scalar::all(0));
  for (std::size_t i = 0; i + 1 < trunk.size(); ++i) {
    if (trunk[i + 1].row_px - trunk[i].row_px > rows_apart_px) continue;
    std::vector<cv::Point> corners;
    for (const Seen* s : {&trunk[i], &trunk[i + 1]}) {
      const auto sides = *detection::sides_of(s->segment, rig_of(s->row_px, config));
      cv::Point left(cvRound(sides.left_x_px), s->row_px),
          right(cvRound(sides.right_x_px), s->row_px);
      if (s == &trunk[i + 1]) std::swap(left, right);
      corners.insert(corners.end(), {left, right});
    }
    cv::fillConvexPoly(mask, corners, cv::Scalar(0, 0, 255));
  }
  cv::imwrite(path, mask);
}

void print(const std::string& name, const Seen& s, const vision::Image& image,
           const io::Config& config) {
  const detection::Rig rig = rig_of(s.row_px, config);
  detection::PictureWidth width;
  width.laser = {s.segment.width_m, s.segment.range_m * s.angle_sd_rad};
  if (const auto view = detection::view_of(s.segment, rig)) {
    const auto pixels = vision::decode(image, detection::windows_area(*view, rig));
    const auto map = vision::edge_map(*pixels, rig.detector.edges);
    const auto by_picture = detection::picture_width(map, *view, s.segment, s.angle_sd_rad, rig);
    if (by_picture) width = *by_picture;
  }
  trials::print_json({{"picture", name},
                      {"row_px", s.row_px},
                      {"beams", s.segment.num_beams},
                      {"range_m", s.segment.range_m},
                      {"angle_sd_m", s.segment.range_m * s.angle_sd_rad},
                      {"laser_m", width.laser.width_m},
                      {"laser_sd_m", width.laser.sd_m},
                      {"picture_m", width.picture.width_m},
                      {"picture_sd_m", width.picture.sd_m},
                      {"fused_m", width.fused.width_m},
                      {"fused_sd_m", width.fused.sd_m},
                      {"width_m", s.detection.width_m},
                      {"tree", s.detection.label == detection::Label::kTree}});
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return 2;
  const io::Config config = io::load_config(argv[3]);
  for (const auto& [name, rows] : read_rows(argv[1])) {
    const std::string path = std::string(argv[2]) + "/" + name + ".jpg";
    const vision::Image image = io::read_picture_file(path);
    std::vector<Seen> seen;
    for (const DepthRow& row : rows) {
      for (const Seen& s : look(row, image, config)) seen.push_back(s);
    }
    const std::vector<Seen> trunk = along_a_trunk(seen, config);
    for (const Seen& s : trunk) print(name, s, image, config);
    if (argc > 4) {
      write_mask(trunk, config, rows[1].row_px - rows[0].row_px,
                 std::string(argv[4]) + "/" + name + ".png");
    }
  }
}
