// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/album/album.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/point_grid.hpp"
#include "mapping/album/framing.hpp"
#include "mapping/pose_composition.hpp"

namespace orchard::mapping {
namespace {

/// Min time between examined images: at 1 m/s base moves 0.5 m in it, and the nearest view of a
/// trunk at 2 m is at most 1 % farther away than the trunk.
constexpr std::int64_t kPicturePeriod_us = 500'000;

/// A longer gap between views starts a new passing, because the pose may have drifted.
constexpr std::int64_t kPassing_us = 10'000'000;
constexpr double kSamePlace_m = 0.3;

/// Minimum ratio of worth for replacing a view.
constexpr double kBetter = 1.05;

/// Limits of the queues for scans and images that wait for each other while poses are late: about a
/// minute.
constexpr std::size_t kWaitingScansMax = 600;
constexpr std::size_t kWaitingPicturesMax = 300;
constexpr std::size_t kPictureBytesMax = std::size_t{64} << 20;

/// Fill level after drop_worst_photographs(), so that it does not run for every photograph.
constexpr double kFilled = 0.9;

constexpr double kBytesPerMb = 1e6;

std::size_t num_bytes_of(const Photograph& photograph) {
  return photograph.jpeg.size() + sizeof(Photograph);
}

bool is_close(double ax_m, double ay_m, double bx_m, double by_m, double gate_m) {
  return std::hypot(ax_m - bx_m, ay_m - by_m) <= gate_m;
}

}  // namespace

Album::Album(const AlbumConfig& config, const detection::Rig& rig)
    : rig_(rig),
      max_bytes_(rig.has_camera ? static_cast<std::size_t>(kBytesPerMb * config.max_mb) : 0) {}

bool Album::keeps_picture(std::int64_t utime) const {
  if (!is_open()) return false;
  if (!last_picture_utime_) return true;
  const std::int64_t since_us = utime - *last_picture_utime_;  // negative if its clock was set back
  return since_us < 0 || since_us >= kPicturePeriod_us;
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
    for (const vision::Image& waiting : pictures_) sum += waiting.data.size();
    return sum;
  };
  pictures_.push_back(image);
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
        [&scan](const vision::Image& waiting) { return waiting.utime == scan.image_utime; });
    if (of_it != pictures_.end()) {
      observe(scan, *of_it);
      // Scans are in order of time, so older images are no longer needed.
      pictures_.erase(pictures_.begin(), of_it);
    }
    ++num_done;
  }
  scans_.erase(scans_.begin(), scans_.begin() + static_cast<std::ptrdiff_t>(num_done));
}

void Album::observe(const WaitingScan& scan, const vision::Image& image) {
  const double dt_s =
      1e-6 * static_cast<double>(scan.image_utime - scan.utime) - rig_.camera_delay_s;
  const std::vector<Framing> framings = frame_subjects(scan.subjects, rig_, scan.motion, dt_s);
  vision::PictureReader picture(image);
  for (const Framing& framing : framings) picture.expect(framing.frame);
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
    if (!(is_worth > kBetter * passing.best.quality)) continue;
    std::vector<std::uint8_t> jpeg = cropped_jpeg(framings[i], picture);
    if (jpeg.empty()) continue;
    num_bytes_ -= num_bytes_of(passing.best);
    passing.best = {scan.utime,       image.utime, framings[i].frame,
                    scan.subjects[i], is_worth,    std::move(jpeg)};
    num_bytes_ += num_bytes_of(passing.best);
  }
  if (num_bytes_ > max_bytes_) drop_worst_photographs();
}

/// Index of the current passing at a position, or of a new one.
std::size_t Album::passing_at(double x_m, double y_m, std::int64_t utime) {
  const auto goes_on = [utime](const Passing& passing) {
    return std::abs(utime - passing.last_utime) <= kPassing_us;
  };
  while (num_over_ < passings_.size() && !goes_on(passings_[num_over_])) ++num_over_;
  std::size_t nearest = passings_.size();
  double nearest_m = kSamePlace_m;
  for (std::size_t i = num_over_; i < passings_.size(); ++i) {
    const double distance_m = std::hypot(passings_[i].x_m - x_m, passings_[i].y_m - y_m);
    if (distance_m >= nearest_m || !goes_on(passings_[i])) continue;
    nearest = i;
    nearest_m = distance_m;
  }
  if (nearest == passings_.size()) {
    passings_.push_back({x_m, y_m, utime, {}});
    num_bytes_ += num_bytes_of(passings_.back().best);
  }
  return nearest;
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
      const std::size_t more = num_bytes_of(passings_[i].best);
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
    if (passing.best.jpeg.empty()) continue;
    const auto pose = pose_at(passing.best.scan_utime);
    if (!pose) continue;
    const Eigen::Vector2d p_map =
        PoseComposition(*pose).apply(passing.best.subject.x_base_m, passing.best.subject.y_base_m);
    all.push_back({passing.best, p_map.x(), p_map.y()});
  }
  return all;
}

}  // namespace orchard::mapping
