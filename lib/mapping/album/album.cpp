// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/album/album.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "detection/trunk_view.hpp"
#include "geometry/point_grid.hpp"
#include "mapping/candidate.hpp"
#include "mapping/tuning.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::mapping {
namespace {

using detection::PlanePoint;

/// derived: Half size of a frame: at least this, and in trunk widths. It should show the
/// surroundings, the ground and the first branches.
constexpr double kHalfFrameMin_m = 0.4;
constexpr double kHalfFrame_widths = 2.0;
constexpr double kHeight_widths = 2.0;  ///< derived: in frame widths: a trunk is taller than wide

/// derived: Minimum half width of a frame, in trunk widths and pixels.
constexpr double kHalfFrameMin_trunks = 1.0;
constexpr double kHalfFrameMin_px = 8.0;

/// derived: the thinnest trunk: what is nearer by less is the same object.
constexpr double kNearer_m = 0.1;
/// derived: a whip is as thin.
constexpr double kThinnest_m = 0.02;
/// derived: bark keeps its detail; a lower quality saves little of such small pictures.
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
  return framing.px_per_m * sharp.detail_per_px * shown *
         (framing.is_hidden ? tuning::kHiddenWorth : 1.0);
}

std::vector<std::uint8_t> cropped_jpeg(const Framing& framing, vision::PictureReader& picture) {
  const auto block = picture.read(framing.frame);
  if (!block) return {};
  const int divisor = (block->area.width_px + kPhotoWidthMax_px - 1) / kPhotoWidthMax_px;
  return vision::write_jpeg(vision::shrunk(*block, divisor), kQuality);
}

namespace {

/// derived: Max distance of a photograph's subject from its landmark's centre [m]; more for wide
/// landmarks.
constexpr double kOfLandmark_m = 0.4;
constexpr double kSearchMax_m = 3.0;

double reach_m(const Landmark& landmark) {
  return std::min(kSearchMax_m, std::max(kOfLandmark_m, 0.5 * landmark.width_m + 0.2));
}

/// Index of the landmark nearest to a photograph's subject; none if it is too far away.
std::optional<std::size_t> landmark_of(const PlacedPhotograph& photograph,
                                       const std::vector<Landmark>& landmarks,
                                       const geometry::PointGrid& grid) {
  std::optional<std::size_t> nearest;
  double nearest_m = kSearchMax_m;
  for (const std::int32_t k : grid.near({photograph.x_m, photograph.y_m}, kSearchMax_m)) {
    const Landmark& landmark = landmarks[static_cast<std::size_t>(k)];
    const double distance_m =
        std::hypot(landmark.x_m - photograph.x_m, landmark.y_m - photograph.y_m);
    if (distance_m >= nearest_m || distance_m > reach_m(landmark)) continue;
    nearest = static_cast<std::size_t>(k);
    nearest_m = distance_m;
  }
  return nearest;
}

}  // namespace

std::vector<AlbumEntry> choose_photographs(const std::vector<Landmark>& landmarks,
                                           const std::vector<PlacedPhotograph>& photographs,
                                           std::size_t max_bytes) {
  geometry::PointGrid grid;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (!std::isfinite(landmarks[i].x_m) || !std::isfinite(landmarks[i].y_m)) continue;
    grid.insert(static_cast<std::int32_t>(i), landmarks[i].x_m, landmarks[i].y_m);
  }
  std::vector<const Photograph*> best(landmarks.size(), nullptr);
  for (const PlacedPhotograph& photograph : photographs) {
    const auto i = landmark_of(photograph, landmarks, grid);
    if (!i) continue;
    if (best[*i] == nullptr || photograph.photograph.quality > best[*i]->quality) {
      best[*i] = &photograph.photograph;
    }
  }
  struct Wanted {
    std::size_t landmark;
    bool is_tree;
  };
  std::vector<Wanted> order;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (best[i] == nullptr) continue;
    order.push_back({i, landmarks[i].label == detection::Label::kTree});
  }
  std::stable_sort(order.begin(), order.end(), [&best](const Wanted& a, const Wanted& b) {
    if (a.is_tree != b.is_tree) return a.is_tree;
    return best[a.landmark]->quality > best[b.landmark]->quality;
  });
  std::vector<AlbumEntry> entries;
  std::size_t num_bytes = 0;
  for (const Wanted& wanted : order) {
    const Photograph* photograph = best[wanted.landmark];
    if (num_bytes + photograph->jpeg.size() > max_bytes) continue;
    num_bytes += photograph->jpeg.size();
    entries.push_back({landmarks[wanted.landmark].id, photograph});
  }
  std::sort(entries.begin(), entries.end(),
            [](const AlbumEntry& a, const AlbumEntry& b) { return a.landmark_id < b.landmark_id; });
  return entries;
}

namespace {

/// derived: Min time between examined images: at 1 m/s base moves 0.5 m in it, and the nearest view
/// of a trunk at 2 m is at most 1 % farther away than the trunk.
constexpr std::int64_t kPicturePeriod_us = 500'000;

/// derived: A longer gap between views starts a new passing, because the pose may have drifted.
constexpr std::int64_t kPassing_us = 10'000'000;
/// derived: half a tree spacing at least separates two trunks.
constexpr double kSamePlace_m = 0.3;

/// derived: Limits of the queues for scans and images that wait for each other while poses are
/// late: about a minute.
constexpr std::size_t kWaitingScansMax = 600;
constexpr std::size_t kWaitingPicturesMax = 300;
constexpr std::size_t kPictureBytesMax = std::size_t{64} << 20;

/// derived: fill level after drop_worst_photographs(), so that it does not run for every
/// photograph.
constexpr double kFilled = 0.9;

// physical: SI.
constexpr double kBytesPerMb = 1e6;

bool is_close(double ax_m, double ay_m, double bx_m, double by_m, double gate_m) {
  return std::hypot(ax_m - bx_m, ay_m - by_m) <= gate_m;
}

}  // namespace

Album::Album(const AlbumConfig& config, const detection::Rig& rig)
    : rig_(rig),
      max_bytes_(rig.has_camera ? static_cast<std::size_t>(kBytesPerMb * config.max_mb) : 0) {}

bool Album::keeps_picture(std::int64_t utime) const {
  if (!is_open()) return false;
  return !last_picture_utime_ || utime - *last_picture_utime_ >= kPicturePeriod_us;
}

void Album::add_scan(std::int64_t utime, std::int64_t image_utime,
                     const pose::PoseEstimate& T_map_base, const detection::Motion& motion,
                     std::vector<Subject> subjects) {
  if (!is_open() || image_utime == 0 || subjects.empty()) return;
  if (scans_.size() >= kWaitingScansMax) scans_.erase(scans_.begin());
  scans_.push_back({utime, image_utime, T_map_base.x_m, T_map_base.y_m, T_map_base.yaw_rad, motion,
                    std::move(subjects)});
  take_scans();
}

void Album::add_picture(const vision::Image& image) {
  if (!keeps_picture(image.utime)) return;
  last_picture_utime_ = image.utime;
  const auto num_bytes = [this] {
    std::size_t sum = 0;
    for (const Picture& waiting : pictures_) sum += waiting->data.size();
    return sum;
  };
  pictures_.push_back(std::make_shared<const vision::Image>(image));
  while (pictures_.size() > 1 &&
         (pictures_.size() > kWaitingPicturesMax || num_bytes() > kPictureBytesMax)) {
    pictures_.erase(pictures_.begin());
  }
  take_scans();
}

void Album::flush() {
  scans_.clear();
  pictures_.clear();
}

/// Processes scans in order; the first one waits until its image or a later one is there.
void Album::take_scans() {
  std::size_t num_done = 0;
  for (const WaitingScan& scan : scans_) {
    if (!last_picture_utime_ || *last_picture_utime_ < scan.image_utime) break;
    const auto of_it = std::find_if(
        pictures_.begin(), pictures_.end(),
        [&scan](const Picture& waiting) { return waiting->utime == scan.image_utime; });
    if (of_it != pictures_.end()) {
      observe(scan, *of_it);
      // Scans are in order of time, so older images are no longer needed.
      pictures_.erase(pictures_.begin(), of_it);
    }
    ++num_done;
  }
  scans_.erase(scans_.begin(), scans_.begin() + static_cast<std::ptrdiff_t>(num_done));
}

void Album::observe(const WaitingScan& scan, const Picture& image) {
  const double dt_s =
      1e-6 * static_cast<double>(scan.image_utime - scan.utime) - rig_.camera_delay_s;
  const std::vector<Framing> framings = frame_subjects(scan.subjects, rig_, scan.motion, dt_s);
  vision::PictureReader picture(*image);
  for (const Framing& framing : framings) picture.expect(framing.trunk);
  pose::PoseEstimate T_map_base;
  T_map_base.x_m = scan.x_m, T_map_base.y_m = scan.y_m, T_map_base.yaw_rad = scan.yaw_rad;
  const PoseComposition composition(T_map_base);
  for (std::size_t i = 0; i < framings.size(); ++i) {
    const double is_worth = quality(framings[i], picture);
    if (!(is_worth > 0.0)) continue;
    const Eigen::Vector2d p_map =
        composition.apply(scan.subjects[i].x_base_m, scan.subjects[i].y_base_m);
    Passing& passing = passings_[passing_at(p_map.x(), p_map.y(), scan.utime)];
    passing.last_utime = scan.utime;
    if (!(is_worth > tuning::kBetter * passing.best.quality)) continue;
    num_bytes_ -= num_bytes_of(passing);
    passing.best = {scan.utime, image->utime, framings[i].frame, scan.subjects[i], is_worth, {}};
    passing.framing = framings[i];
    passing.picture = image;
    num_bytes_ += num_bytes_of(passing);
  }
  if (num_bytes_ > max_bytes_) {
    for (Passing& passing : passings_) cut_out(passing);
  }
  if (num_bytes_ > max_bytes_) drop_worst_photographs();
}

/// Index of the current passing at a position, or of a new one.
std::size_t Album::passing_at(double x_m, double y_m, std::int64_t utime) {
  const auto goes_on = [utime](const Passing& passing) {
    return std::abs(utime - passing.last_utime) <= kPassing_us;
  };
  while (num_over_ < passings_.size() && !goes_on(passings_[num_over_])) {
    cut_out(passings_[num_over_++]);
  }
  std::size_t nearest = passings_.size();
  double nearest_m = kSamePlace_m;
  for (std::size_t i = num_over_; i < passings_.size(); ++i) {
    const double distance_m = std::hypot(passings_[i].x_m - x_m, passings_[i].y_m - y_m);
    if (distance_m >= nearest_m || !goes_on(passings_[i])) continue;
    nearest = i;
    nearest_m = distance_m;
  }
  if (nearest == passings_.size()) {
    passings_.push_back({x_m, y_m, utime, {}, {}, nullptr});
    num_bytes_ += num_bytes_of(passings_.back());
  }
  return nearest;
}

std::size_t Album::num_bytes_of(const Passing& passing) {
  return sizeof(Passing) + passing.best.jpeg.size() +
         (passing.picture ? passing.picture->data.size() : 0);
}

void Album::cut_out(Passing& passing) {
  if (!passing.picture) return;
  num_bytes_ -= num_bytes_of(passing);
  vision::PictureReader picture(*passing.picture);
  passing.best.jpeg = cropped_jpeg(passing.framing, picture);
  passing.picture.reset();
  num_bytes_ += num_bytes_of(passing);
}

/// Frees memory: keeps the best passing of each position in descending worth, then further ones, up
/// to kFilled of the limit.
void Album::drop_worst_photographs() {
  std::vector<std::size_t> order(passings_.size());  // in descending worth
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [this](std::size_t a, std::size_t b) {
    return passings_[a].best.quality > passings_[b].best.quality;
  });
  geometry::PointGrid grid;
  std::vector<std::size_t> kept, again;
  for (const std::size_t i : order) {
    const Passing& it = passings_[i];
    bool has_better = false;
    grid.near(it.x_m, it.y_m, kSamePlace_m, [&](std::int32_t k) {
      const Passing& other = passings_[static_cast<std::size_t>(k)];
      has_better = has_better || is_close(it.x_m, it.y_m, other.x_m, other.y_m, kSamePlace_m);
    });
    (has_better ? again : kept).push_back(i);
    if (!has_better) grid.insert(static_cast<std::int32_t>(i), it.x_m, it.y_m);
  }
  const auto limit = static_cast<std::size_t>(kFilled * static_cast<double>(max_bytes_));
  std::vector<char> stays(passings_.size(), 0);
  num_bytes_ = 0;
  for (const std::vector<std::size_t>* group : {&kept, &again}) {
    for (const std::size_t i : *group) {
      const std::size_t more = num_bytes_of(passings_[i]);
      if (num_bytes_ + more > limit) break;
      num_bytes_ += more;
      stays[i] = 1;
    }
  }
  std::size_t next = 0;
  for (std::size_t i = 0; i < passings_.size(); ++i) {
    if (stays[i] == 0) continue;
    if (next != i) passings_[next] = std::move(passings_[i]);
    ++next;
  }
  passings_.resize(next);
  num_over_ = 0;
}

std::vector<PlacedPhotograph> Album::photographs(
    const std::function<std::optional<pose::PoseEstimate>(std::int64_t)>& pose_at) const {
  std::vector<PlacedPhotograph> all;
  for (const Passing& passing : passings_) {
    const auto pose = pose_at(passing.best.scan_utime);
    if (!pose) continue;
    Photograph best = passing.best;
    if (passing.picture) {
      vision::PictureReader picture(*passing.picture);
      best.jpeg = cropped_jpeg(passing.framing, picture);
    }
    if (best.jpeg.empty()) continue;
    const Eigen::Vector2d p_map =
        PoseComposition(*pose).apply(best.subject.x_base_m, best.subject.y_base_m);
    all.push_back({std::move(best), p_map.x(), p_map.y()});
  }
  return all;
}

}  // namespace orchard::mapping
