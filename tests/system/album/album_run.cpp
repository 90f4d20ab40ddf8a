// SPDX-License-Identifier: BSD-3-Clause
#include "system/album/album_run.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "detector/detector_node.hpp"
#include "io/map/map_folder.hpp"
#include "mapper/mapper_node.hpp"
#include "mapping/album/album.hpp"
#include "pose/pose_node.hpp"
#include "simulation/simulator.hpp"
#include "system/tube_scene/wiring.hpp"

namespace orchard::test {
namespace {

constexpr double kSameTree_m = 0.3;
/// Two codings as JPEG, and shrinking, leave less than this on average.
constexpr double kSameGrey = 8.0;

/// A point of the world's scan plane in the picture, by OpenCV's camera model and the paper's
/// rotation written out, with none of our own.
cv::Point2d pixel_of(double x_m, double y_m, const simulation::TruePose& base,
                     const io::Config& config) {
  const double c = std::cos(base.yaw_rad), s = std::sin(base.yaw_rad);
  const double bx = c * (x_m - base.x_m) + s * (y_m - base.y_m);
  const double by = -s * (x_m - base.x_m) + c * (y_m - base.y_m);
  const double mc = std::cos(config.laser.mount_yaw_rad), ms = std::sin(config.laser.mount_yaw_rad);
  const double lx = bx - config.laser.mount_x_m, ly = by - config.laser.mount_y_m;
  const std::vector<cv::Point3d> p_laser{{mc * lx + ms * ly, -ms * lx + mc * ly, 0.0}};
  const auto& phi = config.camera.extrinsics.phi_rad;
  const auto turn = [](int axis, double angle) {
    cv::Vec3d vector(0.0, 0.0, 0.0);
    vector[axis] = angle;
    cv::Matx33d matrix;
    cv::Rodrigues(vector, matrix);
    return matrix;
  };
  cv::Vec3d rotation;
  cv::Rodrigues(turn(0, phi[0]) * turn(1, phi[1]) * turn(2, phi[2]), rotation);
  const auto& delta = config.camera.extrinsics.delta_m;
  const auto& lens = config.camera.intrinsics;
  const cv::Matx33d matrix(lens.fc_px[0], 0.0, lens.cc_px[0], 0.0, lens.fc_px[1], lens.cc_px[1],
                           0.0, 0.0, 1.0);
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(p_laser, rotation, cv::Vec3d(delta[0], delta[1], delta[2]), matrix,
                    std::vector<double>(lens.kc.begin(), lens.kc.end()), pixels);
  return pixels[0];
}

simulation::TruePose pose_at(const std::vector<simulation::TruePose>& poses, std::int64_t utime) {
  auto after = std::lower_bound(
      poses.begin(), poses.end(), utime,
      [](const simulation::TruePose& pose, std::int64_t time) { return pose.utime < time; });
  if (after == poses.begin()) return poses.front();
  if (after == poses.end()) return poses.back();
  const auto before = after - 1;
  const double f = static_cast<double>(utime - before->utime) /
                   static_cast<double>(after->utime - before->utime);
  simulation::TruePose pose{utime, 0.0, 0.0, 0.0};
  pose.x_m = before->x_m + f * (after->x_m - before->x_m);
  pose.y_m = before->y_m + f * (after->y_m - before->y_m);
  pose.yaw_rad = before->yaw_rad + f * std::remainder(after->yaw_rad - before->yaw_rad, 2.0 * M_PI);
  return pose;
}

bool is_in_middle_third(const cv::Point2d& p, const vision::PixelRect& frame) {
  const double x = (p.x - frame.x_px + 0.5) / frame.width_px;
  const double y = (p.y - frame.y_px + 0.5) / frame.height_px;
  return x >= 1.0 / 3.0 && x <= 2.0 / 3.0 && y >= 1.0 / 3.0 && y <= 2.0 / 3.0;
}

bool shows(const std::vector<std::uint8_t>& jpeg, const vision::Image& image,
           const vision::PixelRect& frame) {
  const cv::Mat photograph = cv::imdecode(jpeg, cv::IMREAD_COLOR);
  const cv::Mat whole = cv::imdecode(image.data, cv::IMREAD_COLOR);
  const cv::Rect part(frame.x_px, frame.y_px, frame.width_px, frame.height_px);
  if (photograph.empty() || whole.empty() || (part & cv::Rect({}, whole.size())) != part) {
    return false;
  }
  cv::Mat scaled, difference;
  cv::resize(whole(part), scaled, photograph.size(), 0.0, 0.0, cv::INTER_AREA);
  cv::absdiff(photograph, scaled, difference);
  const cv::Scalar mean = cv::mean(difference);
  return (mean[0] + mean[1] + mean[2]) / 3.0 < kSameGrey;
}

const simulation::TruthObject* true_tree(const mapping::Landmark& landmark,
                                         const std::vector<simulation::TruthObject>& truth) {
  for (const simulation::TruthObject& object : truth) {
    if (object.label != detection::Label::kTree) continue;
    if (std::hypot(object.x_m - landmark.x_m, object.y_m - landmark.y_m) < kSameTree_m) {
      return &object;
    }
  }
  return nullptr;
}

}  // namespace

AlbumOutcome run_album(const io::Config& config, unsigned long seed, const std::string& folder) {
  simulation::Simulator simulator(simulation::SceneKind::kOrchard, seed,
                                  {config.laser, config.camera, config.simulation, {}});
  procs::DetectorNode detector(config);
  procs::PoseNode pose(config);
  procs::MapperNode mapper(config);
  Wiring wiring({&detector, &pose, &mapper});
  std::map<std::int64_t, vision::Image> pictures;
  while (const auto message = simulator.next()) {
    std::visit([&wiring](const auto& it) { wiring.put(it); }, *message);
    if (const auto* image = std::get_if<vision::Image>(&*message)) {
      pictures[image->utime] = *image;
    }
  }
  wiring.flush();
  const io::MapFolderContent content = mapper.content({});
  if (!folder.empty()) io::write_map_folder(folder, content);

  AlbumOutcome outcome;
  const std::vector<simulation::TruthObject> truth = simulator.truth();
  const std::vector<simulation::TruePose> poses = simulator.true_poses();
  outcome.num_true_trees = static_cast<int>(
      std::count_if(truth.begin(), truth.end(), [](const simulation::TruthObject& object) {
        return object.label == detection::Label::kTree;
      }));
  std::map<std::int32_t, const mapping::Photograph*> album;
  for (const mapping::AlbumEntry& entry : mapping::choose_photographs(
           content.landmarks, content.photographs, content.album_bytes_max)) {
    album[entry.landmark_id] = entry.photograph;
    outcome.num_bytes += entry.photograph->jpeg.size();
  }
  for (const mapping::Landmark& landmark : content.landmarks) {
    const auto* tree = true_tree(landmark, truth);
    if (landmark.label != detection::Label::kTree || tree == nullptr) continue;
    ++outcome.num_trees;
    const auto found = album.find(landmark.id);
    if (found == album.end()) continue;
    ++outcome.num_photographed;
    const mapping::Photograph& photograph = *found->second;
    const auto base = pose_at(poses, photograph.image_utime);
    const cv::Point2d axis = pixel_of(tree->x_m, tree->y_m, base, config);
    outcome.num_centred += is_in_middle_third(axis, photograph.frame);
    outcome.num_same +=
        shows(photograph.jpeg, pictures.at(photograph.image_utime), photograph.frame);
  }
  return outcome;
}

}  // namespace orchard::test
