// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/album/framing.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>

#include "detection/trunk_view.hpp"
#include "vision/jpeg_writer.hpp"
#include "vision/sharpness.hpp"

namespace orchard::mapping {
namespace {

using detection::PlanePoint;

/// Half size of a frame: at least this, and in trunk widths. It should show the surroundings, the
/// ground and the first branches.
constexpr double kHalfFrameMin_m = 0.4;
constexpr double kHalfFrame_widths = 2.0;
constexpr double kHeight_widths = 2.0;  ///< height of a frame, in frame widths

/// Minimum half width of a frame, in trunk widths and pixels.
constexpr double kHalfFrameMin_trunks = 1.0;
constexpr double kHalfFrameMin_px = 8.0;

/// Factor on the worth of a partly hidden subject: less than a poorer image of the whole.
constexpr double kHiddenWorth = 0.2;
constexpr double kNearer_m = 0.1;
constexpr double kThinnest_m = 0.02;
constexpr int kQuality = 80;

/// An object in the image, in pixels.
struct Seen {
  Eigen::Vector2d pixel;
  double depth_m;
  double half_px;
};

std::optional<Seen> seen(const Subject& subject, const detection::Rig& rig,
                         const detection::Motion& motion, double dt_s) {
  const PlanePoint base =
      detection::after_motion({subject.x_base_m, subject.y_base_m}, motion, dt_s);
  const double c = std::cos(rig.laser.mount_yaw_rad), s = std::sin(rig.laser.mount_yaw_rad);
  const double x_m = base.x_m - rig.laser.mount_x_m, y_m = base.y_m - rig.laser.mount_y_m;
  const Eigen::Vector3d p_camera =
      rig.T_camera_laser(Eigen::Vector3d(c * x_m + s * y_m, -s * x_m + c * y_m, 0.0));
  const auto pixel = rig.camera.project(p_camera);
  if (!pixel) return std::nullopt;
  const double width_m = std::max(subject.width_m, kThinnest_m);
  const double depth_m = p_camera.z() - 0.5 * width_m;
  if (!(depth_m > 0.0) || !std::isfinite(depth_m)) return std::nullopt;
  return Seen{*pixel, depth_m, 0.5 * width_m * rig.camera.intrinsics().fc_px[0] / depth_m};
}

/// A rectangle of whole pixels centred on a point.
vision::PixelRect around(const Eigen::Vector2d& p, double half_width_px, double half_height_px) {
  vision::PixelRect rect;
  rect.x_px = static_cast<int>(std::lround(p.x() - half_width_px));
  rect.y_px = static_cast<int>(std::lround(p.y() - half_height_px));
  rect.width_px = static_cast<int>(std::lround(p.x() + half_width_px)) - rect.x_px + 1;
  rect.height_px = static_cast<int>(std::lround(p.y() + half_height_px)) - rect.y_px + 1;
  return rect;
}

Framing framing_of(const Seen& it, double width_m, const detection::Rig& rig) {
  const vision::PixelRect picture = detection::picture_of(rig);
  const auto& intrinsics = rig.camera.intrinsics();
  const double wanted_m = std::max(kHalfFrameMin_m, kHalfFrame_widths * width_m);
  const double wanted_px = wanted_m * intrinsics.fc_px[0] / it.depth_m;
  const double wanted_height_px = kHeight_widths * wanted_m * intrinsics.fc_px[1] / it.depth_m;
  // Crop symmetrically at the image border, so that the axis stays in the middle.
  const double room_px = std::min(it.pixel.x(), intrinsics.width_px - 1 - it.pixel.x());
  const double room_height_px = std::min(it.pixel.y(), intrinsics.height_px - 1 - it.pixel.y());
  const double half_px = std::min(wanted_px, room_px);
  const double half_height_px = std::min(wanted_height_px, room_height_px);
  Framing framing;
  const double least_px = std::max(kHalfFrameMin_px, 2.0 * kHalfFrameMin_trunks * it.half_px);
  if (!(half_px >= least_px) || !(half_height_px >= least_px)) return framing;
  framing.frame = vision::intersection(around(it.pixel, half_px, half_height_px), picture);
  framing.trunk = vision::intersection(
      around(it.pixel, 2.0 * it.half_px + 2.0, std::min(half_height_px, 4.0 * it.half_px + 2.0)),
      framing.frame);
  framing.px_per_m = intrinsics.fc_px[0] / it.depth_m;
  framing.fraction = half_px / wanted_px;
  return framing;
}

}  // namespace

std::vector<Framing> frame_subjects(const std::vector<Subject>& subjects, const detection::Rig& rig,
                                    const detection::Motion& motion, double dt_s) {
  std::vector<std::optional<Seen>> all;
  for (const Subject& subject : subjects) all.push_back(seen(subject, rig, motion, dt_s));
  std::vector<Framing> framings(subjects.size());
  for (std::size_t i = 0; i < subjects.size(); ++i) {
    if (!all[i]) continue;
    const Seen& it = *all[i];
    bool is_covered = false, is_touched = subjects[i].occlusion != 0;
    for (std::size_t k = 0; k < subjects.size(); ++k) {
      if (k == i || !all[k] || all[k]->depth_m > it.depth_m - kNearer_m) continue;
      const double apart_px = std::abs(all[k]->pixel.x() - it.pixel.x());
      is_covered = is_covered || apart_px < all[k]->half_px;  // the axis itself is hidden
      is_touched = is_touched || apart_px < all[k]->half_px + it.half_px;
    }
    if (is_covered) continue;
    framings[i] = framing_of(it, subjects[i].width_m, rig);
    framings[i].is_hidden = is_touched;
  }
  return framings;
}

double quality(const Framing& framing, vision::PictureReader& picture) {
  if (framing.frame.empty()) return 0.0;
  const auto block = picture.read(framing.trunk);
  if (!block) return 0.0;
  const vision::Sharpness sharp = vision::sharpness(*block);
  const double shown = framing.fraction * framing.fraction * (1.0 - sharp.clipped_fraction);
  return framing.px_per_m * sharp.detail_per_px * shown * (framing.is_hidden ? kHiddenWorth : 1.0);
}

std::vector<std::uint8_t> cropped_jpeg(const Framing& framing, vision::PictureReader& picture) {
  const auto block = picture.read(framing.frame);
  if (!block) return {};
  const int divisor = (block->area.width_px + kPhotoWidthMax_px - 1) / kPhotoWidthMax_px;
  return vision::write_jpeg(vision::shrunk(*block, divisor), kQuality);
}

}  // namespace orchard::mapping
