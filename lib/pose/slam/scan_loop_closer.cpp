// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/scan_loop_closer.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/pose2.hpp"
#include "pose/scan_matching/scan_motion.hpp"
#include "pose/slam/slam_map.hpp"
#include "pose/tuning.hpp"

namespace orchard::pose {

using geometry::between;
using geometry::compose;
using geometry::rotation;
namespace {

// physical: leaves and bark before a return, so that the last of a beam frees no cell [m].
constexpr double kBeforeHit_m = 0.6;
// derived: kHit at two standard deviations; some tenths of a second of lookups.
constexpr int kBesideMin = 15;
constexpr std::int64_t kOperationsMax = 60'000'000;

struct Node {
  int turn = 0;
  int x = 0;  ///< shift of the square's first pose [cells]
  int y = 0;
  int level = 0;
  int bound = 0;
};

class Search {
 public:
  Search(const std::vector<Eigen::Vector2d>& points, const OccupancyPyramid& raster,
         const PoseSearchWindow& window)
      : raster_(raster), window_(window) {
    double farthest_m = 1.0;
    for (const Eigen::Vector2d& p : points) farthest_m = std::max(farthest_m, p.norm());
    turn_step_rad_ = raster.cell_m() / farthest_m;
    num_turns_ = static_cast<int>(std::ceil(window.half_turn_rad / turn_step_rad_));
    num_shifts_ = static_cast<int>(std::ceil(window.half_side_m / raster.cell_m()));
    for (int turn = -num_turns_; turn <= num_turns_; ++turn) {
      const Eigen::Vector3d T = place(turn, 0, 0);
      std::vector<Eigen::Vector2i>& cells = cells_.emplace_back();
      for (const Eigen::Vector2d& p : points) {
        const Eigen::Vector2d p_map = geometry::transform(T, p);
        cells.emplace_back(raster.column(p_map.x()), raster.row(p_map.y()));
      }
    }
  }

  Eigen::Vector3d place(int turn, int x, int y) const {
    return {window_.T_map_submap.x() + x * raster_.cell_m(),
            window_.T_map_submap.y() + y * raster_.cell_m(),
            geometry::wrap_angle_rad(window_.T_map_submap.z() + turn * turn_step_rad_)};
  }

  /// Finds the best pose with a score above `beaten`, different from `apart_from` if given.
  bool run(int beaten, const Node* apart_from, double same_m, double same_rad, Node& best) {
    apart_from_ = apart_from;
    same_cells_ = same_m / raster_.cell_m();
    same_turns_ = same_rad / turn_step_rad_;
    best_ = nullptr;
    best_score_ = beaten;
    // derived: the coarsest.
    constexpr int kTop = OccupancyPyramid::kLevels - 1;
    std::vector<Node> nodes;
    for (int turn = -num_turns_; turn <= num_turns_; ++turn) {
      for (int x = -num_shifts_; x <= num_shifts_; x += 1 << kTop) {
        for (int y = -num_shifts_; y <= num_shifts_; y += 1 << kTop) {
          nodes.push_back({turn, x, y, kTop, bound(turn, x, y, kTop)});
        }
      }
    }
    descend(nodes, best);
    return best_ != nullptr;
  }

  bool exhausted() const { return num_operations_ >= kOperationsMax; }
  std::int64_t num_operations() const { return num_operations_; }

  int num_known(const Node& node) const {
    int known = 0;
    for (const Eigen::Vector2i& cell : cells(node.turn)) {
      known += raster_.best(0, cell.x() + node.x, cell.y() + node.y) != 0;
    }
    return known;
  }

 private:
  const std::vector<Eigen::Vector2i>& cells(int turn) const { return cells_[turn + num_turns_]; }

  int bound(int turn, int x, int y, int level) {
    num_operations_ += static_cast<std::int64_t>(cells(turn).size());
    int sum = 0;
    for (const Eigen::Vector2i& cell : cells(turn)) {
      sum += raster_.best(level, cell.x() + x, cell.y() + y);
    }
    return sum;
  }

  /// True if all poses of a square count as the same as `apart_from_`.
  bool is_same(const Node& node) const {
    if (!apart_from_ || std::abs(node.turn - apart_from_->turn) > same_turns_) return false;
    const int last = (1 << node.level) - 1;
    const double dx =
        std::max(std::abs(node.x - apart_from_->x), std::abs(node.x + last - apart_from_->x));
    const double dy =
        std::max(std::abs(node.y - apart_from_->y), std::abs(node.y + last - apart_from_->y));
    return std::hypot(dx, dy) <= same_cells_;
  }

  void descend(std::vector<Node>& nodes, Node& best) {
    std::stable_sort(nodes.begin(), nodes.end(),
                     [](const Node& a, const Node& b) { return a.bound > b.bound; });
    for (const Node& node : nodes) {
      if (node.bound <= best_score_ || exhausted()) return;
      if (is_same(node)) continue;
      if (node.level == 0) {
        best = node;
        best_ = &best;
        best_score_ = node.bound;
        continue;
      }
      const int half = 1 << (node.level - 1);
      std::vector<Node> parts;
      for (const int x : {node.x, node.x + half}) {
        for (const int y : {node.y, node.y + half}) {
          if (x > num_shifts_ || y > num_shifts_) continue;
          parts.push_back(
              {node.turn, x, y, node.level - 1, bound(node.turn, x, y, node.level - 1)});
        }
      }
      descend(parts, best);
    }
  }

  const OccupancyPyramid& raster_;
  const PoseSearchWindow& window_;
  double turn_step_rad_ = 0.01;
  int num_turns_ = 0;
  int num_shifts_ = 0;
  std::vector<std::vector<Eigen::Vector2i>> cells_;  ///< cells of the points, per turn
  const Node* apart_from_ = nullptr;
  double same_cells_ = 0.0;
  double same_turns_ = 0.0;
  const Node* best_ = nullptr;
  int best_score_ = 0;
  std::int64_t num_operations_ = 0;
};

// derived: side of the squares with one return, as for matching [m]. The scans of 20 m are
// registered to those of twice as long ago, every 5 m, unless three old trunks or the standard
// deviation say that the pose is known.
constexpr double kThinning_m = 0.10;
constexpr double kStretch_m = 20.0;
constexpr double kOld_m = 2.0 * kStretch_m;
constexpr int kAnchorsEnough = 3;
constexpr double kAskEvery_m = 5.0;
constexpr double kAskSd_m = 0.10;

// derived: the window is four standard deviations of the pose; at least so that it includes rivals
// one tree or row away, at most what a search can try.
constexpr double kWindowSigmas = 4.0;
constexpr double kSearchMin_m = 4.0;
constexpr double kSearchMax_m = 40.0;
constexpr double kSearchTurnMin_rad = 0.05;
constexpr double kSearchTurnMax_rad = 0.7;

// derived: cells above the roughness, and squares with one point each, so that walls and hedges
// count by their length [m]; budgets of points.
constexpr double kRasterCell_m = 0.2;
constexpr double kPointSpacing_m = 0.3;
constexpr std::size_t kPointsMin = 60;
constexpr std::size_t kPointsMax = 400;

// derived: poses within some cells are the same; the fit of all points moves less than they do, and
// is told to a point's spacing.
constexpr double kSame_m = 1.2;
constexpr double kSame_rad = 0.12;
constexpr double kFitShift_m = 0.6;
constexpr double kFitTurn_rad = 0.1;
constexpr double kFitSd_m = 0.3;

// physical: the registered part of the path is bent by so much.
constexpr double kBendSd_m = 0.05;
constexpr double kBendSd_rad = 0.005;

// derived: five standard deviations off after the solve refute a closure. One that moves the robot
// by more needs a solve of the whole graph, which is only done after it has grown by a fiftieth.
constexpr double kRefuted2 = 25.0;
constexpr double kMoves_m = 0.3;
constexpr double kScanSolveGrowth = 0.02;

Eigen::Vector3d bend_variance() {
  return {kBendSd_m * kBendSd_m, kBendSd_m * kBendSd_m, kBendSd_rad * kBendSd_rad};
}

double distance2(const RelativePose& r, const SlamGraph& graph, const Eigen::Matrix3d& P) {
  Eigen::Vector3d e =
      between(graph.keyframes[r.from].T_map_base, graph.keyframes[r.to].T_map_base) - r.T_from_to;
  e.z() = geometry::wrap_angle_rad(e.z());
  return e.dot(P.inverse() * e);
}

bool is_held_by_old_trunks(const SlamMap& map) {
  const SlamGraph& graph = map.graph;
  const double now_m = graph.keyframes.back().travel_m;
  int anchors = 0;
  for (const int l : map.local) {
    const SlamLandmark& landmark = graph.landmarks[l];
    if (landmark.keyframes.size() < 2 || !landmark.confirmed) continue;
    const int last = landmark.keyframes.back();
    if (last < map.session_start || now_m - graph.keyframes[last].travel_m > kAskEvery_m) continue;
    if (now_m - graph.keyframes[landmark.keyframes.front()].travel_m > kOld_m) ++anchors;
  }
  return anchors >= kAnchorsEnough;
}

/// Rotates a fit's covariance, whose (x, y) are in map, into the axes of a keyframe.
Eigen::Matrix3d in_axes_of(const Eigen::Vector3d& T_map_base, const Eigen::Matrix3d& P_map) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(-T_map_base.z());
  return R * P_map * R.transpose();
}

}  // namespace

OccupancyPyramid::OccupancyPyramid(const Eigen::Vector2d& centre_map, double half_side_m,
                                   double cell_m, double kernel_m)
    : cell_m_(cell_m),
      kernel_m_(kernel_m),
      side_(2 * static_cast<int>(std::ceil(half_side_m / cell_m)) + 1),
      corner_map_(centre_map.array() - 0.5 * side_ * cell_m),
      passed_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), 0),
      levels_(1, std::vector<std::int8_t>(passed_.size(), 0)) {}

int OccupancyPyramid::column(double x_map_m) const {
  return static_cast<int>(std::floor((x_map_m - corner_map_.x()) / cell_m_));
}

int OccupancyPyramid::row(double y_map_m) const {
  return static_cast<int>(std::floor((y_map_m - corner_map_.y()) / cell_m_));
}

void OccupancyPyramid::add(const Eigen::Vector2d& laser_map, const Eigen::Vector2d& hit_map) {
  const auto index = [this](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(side_) +
           static_cast<std::size_t>(x);
  };
  const double length_m = (hit_map - laser_map).norm();
  const int steps = static_cast<int>((length_m - kBeforeHit_m) / cell_m_);
  for (int step = 0; step < steps; ++step) {
    const Eigen::Vector2d p = laser_map + (step * cell_m_ / length_m) * (hit_map - laser_map);
    const int x = column(p.x()), y = row(p.y());
    if (x >= 0 && y >= 0 && x < side_ && y < side_) passed_[index(x, y)] = 1;
  }
  const int reach = static_cast<int>(std::ceil(2.0 * kernel_m_ / cell_m_));
  const int x0 = column(hit_map.x()), y0 = row(hit_map.y());
  for (int y = std::max(0, y0 - reach); y <= std::min(side_ - 1, y0 + reach); ++y) {
    for (int x = std::max(0, x0 - reach); x <= std::min(side_ - 1, x0 + reach); ++x) {
      const double d2 = ((x - x0) * (x - x0) + (y - y0) * (y - y0)) * cell_m_ * cell_m_;
      const int value =
          static_cast<int>(std::lround(kHit * std::exp(-0.5 * d2 / (kernel_m_ * kernel_m_))));
      std::int8_t& cell = levels_[0][index(x, y)];
      if (value >= kBesideMin && value > cell) cell = static_cast<std::int8_t>(value);
    }
  }
}

void OccupancyPyramid::finish() {
  for (std::size_t i = 0; i < passed_.size(); ++i) {
    if (levels_[0][i] == 0 && passed_[i] != 0) levels_[0][i] = kThrough;
  }
  const auto n = static_cast<std::size_t>(side_);
  for (int level = 1; level < kLevels; ++level) {
    const std::vector<std::int8_t>& fine = levels_.back();
    const std::size_t step = std::size_t{1} << (level - 1);
    std::vector<std::int8_t> wide(fine.size());
    for (std::size_t y = 0; y < n; ++y) {
      for (std::size_t x = 0; x < n; ++x) {
        // Cells outside the raster are unknown: 0.
        const std::int8_t right = x + step < n ? fine[y * n + x + step] : std::int8_t{0};
        wide[y * n + x] = std::max(fine[y * n + x], right);
      }
    }
    std::vector<std::int8_t> coarse(fine.size());
    for (std::size_t y = 0; y < n; ++y) {
      for (std::size_t x = 0; x < n; ++x) {
        const std::int8_t below = y + step < n ? wide[(y + step) * n + x] : std::int8_t{0};
        coarse[y * n + x] = std::max(wide[y * n + x], below);
      }
    }
    levels_.push_back(std::move(coarse));
  }
}

PoseSearchResult find_submap_pose(const std::vector<Eigen::Vector2d>& points,
                                  const OccupancyPyramid& raster, const PoseSearchWindow& window,
                                  double same_m, double same_rad, double lead) {
  PoseSearchResult result;
  if (points.empty()) return result;
  Search search(points, raster, window);
  Node best, rival;
  const bool any = search.run(0, nullptr, same_m, same_rad, best) && !search.exhausted();
  if (any) {
    result.T_map_submap = search.place(best.turn, best.x, best.y);
    result.score = static_cast<double>(best.bound) / OccupancyPyramid::kHit;
    result.on_known = search.num_known(best);
    const int beaten = static_cast<int>(std::floor((1.0 - lead) * best.bound));
    result.ambiguous = search.run(beaten, &best, same_m, same_rad, rival) || search.exhausted();
    result.found = true;
  }
  result.num_operations = search.num_operations();
  return result;
}

KeyframeScans::KeyframeScans(std::shared_ptr<ChunkAllocator> memory)
    : memory_(std::make_unique<RecordStore<Packed>>(
          memory ? std::move(memory) : std::make_shared<HeapChunkAllocator>())) {}

const KeyframeScans::Scan* KeyframeScans::find(int keyframe) const {
  const auto scan =
      std::lower_bound(scans_.begin(), scans_.end(), keyframe,
                       [](const Scan& one, int other) { return one.keyframe < other; });
  return scan != scans_.end() && scan->keyframe == keyframe ? &*scan : nullptr;
}

void KeyframeScans::keep(int keyframe, const std::vector<SurfacePoint>& points) {
  std::vector<Packed> packed;
  for (const SurfacePoint& point : thinned(points, kThinning_m)) {
    const Eigen::Vector2f p = point.p.cast<float>();
    const Eigen::Vector2f n = point.flat ? Eigen::Vector2f(point.normal.cast<float>())
                                         : Eigen::Vector2f(Eigen::Vector2f::Zero());
    packed.push_back({p.x(), p.y(), n.x(), n.y()});
  }
  const auto num_points = static_cast<std::uint32_t>(packed.size());
  Scan scan{keyframe, num_points, memory_->keep(packed), nullptr};
  if (scan.place.first == nullptr) scan.large = large_.emplace_back(std::move(packed)).data();
  scans_.push_back(scan);
}

std::vector<SurfacePoint> KeyframeScans::points(int keyframe,
                                                const Eigen::Vector3d& T_frame_base) const {
  std::vector<SurfacePoint> points;
  const Scan* scan = find(keyframe);
  if (scan == nullptr) return points;
  const Eigen::Matrix2d R = geometry::rotation(T_frame_base.z());
  points.reserve(scan->num_points);
  if (scan->large == nullptr) memory_->use(scan->place);
  const Packed* const all = scan->large != nullptr ? scan->large : scan->place.first;
  for (std::uint32_t i = 0; i < scan->num_points; ++i) {
    const Packed& packed = all[i];
    SurfacePoint point;
    point.p = R * Eigen::Vector2d(packed.x_m, packed.y_m) + T_frame_base.head<2>();
    point.normal = R * Eigen::Vector2d(packed.normal_x, packed.normal_y);
    point.flat = packed.normal_x != 0.0f || packed.normal_y != 0.0f;
    points.push_back(point);
  }
  return points;
}

std::vector<int> KeyframeScans::between(int first, int end) const {
  std::vector<int> keyframes;
  for (const Scan& scan : scans_) {
    if (scan.keyframe >= first && scan.keyframe < end) keyframes.push_back(scan.keyframe);
  }
  return keyframes;
}

ScanLoopCloser::ScanLoopCloser(const ScanMotionConfig& config, const laser::LaserConfig& mount,
                               std::shared_ptr<ChunkAllocator> memory)
    : config_(config), mount_(mount), scans_(std::move(memory)), points_(config) {}

/// Replaces the points of points_ by the scans of these keyframes, in map.
void ScanLoopCloser::refill(const SlamMap& map, const std::vector<int>& keyframes) {
  filling_ += 1.0;
  points_.forget_before(filling_);
  for (const int k : keyframes) {
    for (const SurfacePoint& p : scans_.points(k, map.graph.keyframes[k].T_map_base)) {
      points_.insert(p, filling_);
    }
  }
}

void ScanLoopCloser::keep(const std::vector<SurfacePoint>& points, const SlamMap& map) {
  scans_.keep(map.newest(), points);
}

/// Returns the old keyframe whose scan has the most points in common with `points` at T_map_base.
int ScanLoopCloser::best_supporting_keyframe(const SlamMap& map, const Eigen::Vector3d& T_map_base,
                                             const std::vector<SurfacePoint>& points,
                                             const std::vector<int>& old) {
  filling_ += 1.0;
  points_.forget_before(filling_);
  for (SurfacePoint p : points) {
    p.p = geometry::transform(T_map_base, p.p);
    points_.insert(p, filling_);
  }
  int best = old.front();
  int most = -1;
  for (const int k : old) {
    int shared = 0;
    double d2 = 0.0;
    for (const SurfacePoint& p : scans_.points(k, map.graph.keyframes[k].T_map_base)) {
      shared += points_.nearest(p.p, kPointSpacing_m, d2) != nullptr;
    }
    if (shared <= most) continue;
    most = shared;
    best = k;
  }
  return best;
}

std::optional<RelativePose> ScanLoopCloser::verified(const SlamMap& map,
                                                     const Eigen::Vector3d& T_map_base,
                                                     const std::vector<int>& recent,
                                                     const std::vector<int>& old) {
  const std::vector<Keyframe>& keyframes = map.graph.keyframes;
  std::vector<SurfacePoint> points;
  for (const int k : recent) {
    const Eigen::Vector3d T = between(keyframes[map.newest()].T_map_base, keyframes[k].T_map_base);
    for (const SurfacePoint& p : scans_.points(k, T)) points.push_back(p);
  }
  points = thinned(points, kPointSpacing_m);
  RelativePose r;
  r.from = best_supporting_keyframe(map, T_map_base, points, old);
  r.to = map.newest();
  std::vector<int> stretch;
  for (const int k : old) {
    const double apart_m = std::abs(keyframes[k].travel_m - keyframes[r.from].travel_m);
    if (apart_m <= kStretch_m) stretch.push_back(k);
  }
  refill(map, stretch);
  const ScanMatcher matcher(points_);
  const ScanMatch match = matcher.refined(points, T_map_base);
  const Eigen::Vector3d off = between(T_map_base, match.T_map_base);
  if (off.head<2>().norm() > kFitShift_m || std::abs(off.z()) > kFitTurn_rad ||
      match.score < kScanClosureFitMin) {
    return std::nullopt;
  }
  r.T_from_to = between(keyframes[r.from].T_map_base, match.T_map_base);
  r.covariance = in_axes_of(keyframes[r.from].T_map_base, covariance_of(matcher, points, match));
  if (position_sd_m(r.covariance) > kFitSd_m) return std::nullopt;
  r.covariance.diagonal() += bend_variance();
  return r;
}

std::optional<RelativePose> ScanLoopCloser::find(const SlamMap& map) {
  const std::vector<Keyframe>& keyframes = map.graph.keyframes;
  const Keyframe& now = keyframes.back();
  const double sd_m = position_sd_m(now.covariance);
  const double window_m = std::clamp(kWindowSigmas * sd_m, kSearchMin_m, kSearchMax_m);
  const auto ago_m = [&](int k) { return now.travel_m - keyframes[k].travel_m; };
  std::vector<int> recent, old;
  bool is_back = false;
  for (const int k : scans_.between(0, map.newest() + 1)) {
    if (ago_m(k) <= kStretch_m && k >= map.session_start) recent.push_back(k);
    if (ago_m(k) < kOld_m) continue;
    const double away_m = (keyframes[k].T_map_base - now.T_map_base).head<2>().norm();
    if (away_m > window_m + config_.range_max_m) continue;
    old.push_back(k);
    is_back |= away_m <= window_m + 0.25 * config_.range_max_m;
  }
  if (!is_back || recent.empty()) return std::nullopt;

  std::vector<SurfacePoint> all;
  for (const int k : recent) {
    const Eigen::Vector3d T = between(now.T_map_base, keyframes[k].T_map_base);
    for (const SurfacePoint& p : scans_.points(k, T)) all.push_back(p);
  }
  all = thinned(all, kPointSpacing_m);
  if (all.size() < kPointsMin) return std::nullopt;
  ++counts_.num_searches;
  std::vector<Eigen::Vector2d> points;
  double farthest_m = 0.0;
  const std::size_t step = 1 + all.size() / kPointsMax;
  for (std::size_t i = 0; i < all.size(); i += step) {
    points.push_back(all[i].p);
    farthest_m = std::max(farthest_m, all[i].p.norm());
  }
  const double kernel_m =
      std::hypot(kScanRoughness_m, mount_.range_sd_at(0.5 * config_.range_max_m));
  OccupancyPyramid raster(now.T_map_base.head<2>(), window_m + farthest_m, kRasterCell_m, kernel_m);
  for (const int k : old) {
    const Eigen::Vector3d& T = keyframes[k].T_map_base;
    const Eigen::Vector2d laser = geometry::transform(T, {mount_.mount_x_m, mount_.mount_y_m});
    for (const SurfacePoint& p : scans_.points(k, T)) raster.add(laser, p.p);
  }
  raster.finish();
  PoseSearchWindow window;
  window.T_map_submap = now.T_map_base;
  window.half_side_m = window_m;
  window.half_turn_rad = std::clamp(kWindowSigmas * std::sqrt(std::max(0.0, now.covariance(2, 2))),
                                    kSearchTurnMin_rad, kSearchTurnMax_rad);
  const PoseSearchResult place =
      find_submap_pose(points, raster, window, kSame_m, kSame_rad, kScanClosureLead);
  counts_.num_operations += place.num_operations;
  if (!place.found || place.on_known < kScanClosureKnownMin * static_cast<double>(points.size()) ||
      place.score < kScanClosureScoreMin * place.on_known) {
    return std::nullopt;
  }
  if (place.ambiguous) return std::nullopt;
  return verified(map, place.T_map_submap, recent, old);
}

bool ScanLoopCloser::observe(SlamMap& map) {
  const Keyframe& now = map.graph.keyframes.back();
  if (!scans_.has(map.newest()) || now.travel_m - asked_m_ < kAskEvery_m ||
      position_sd_m(now.covariance) < kAskSd_m || is_held_by_old_trunks(map)) {
    return false;
  }
  asked_m_ = now.travel_m;
  const std::optional<RelativePose> found = find(map);
  if (!found) return false;
  const Eigen::Vector3d moved = between(
      now.T_map_base, compose(map.graph.keyframes[found->from].T_map_base, found->T_from_to));
  const bool is_large = moved.head<2>().norm() > kMoves_m || map.session_start > 0;
  const int num_keyframes = map.newest() + 1;
  if (is_large && num_keyframes < solved_keyframes_ * (1.0 + kScanSolveGrowth)) return false;
  if (!is_large) {
    map.graph.relative_poses.push_back(*found);
    ++counts_.num_closures;
    return true;
  }
  solved_keyframes_ = num_keyframes;
  SlamUndo undo(map);
  map.graph.relative_poses.push_back(*found);
  if (map.solve(SolveReason::kLoopClosure) &&
      distance2(*found, map.graph, found->covariance) <= kRefuted2) {
    map.session_start = 0;
    ++counts_.num_closures;
    return true;
  }
  undo.restore();
  ++counts_.num_refuted;
  return false;
}

bool ScanLoopCloser::drop_contradicted(SlamMap& map) {
  std::vector<RelativePose>& all = map.graph.relative_poses;
  const auto is_contradicted = [&](const RelativePose& r) {
    return distance2(r, map.graph, r.covariance) > kRefuted2;
  };
  const auto end = std::remove_if(all.begin(), all.end(), is_contradicted);
  const bool any = end != all.end();
  counts_.num_refuted += static_cast<int>(std::distance(end, all.end()));
  all.erase(end, all.end());
  return any;
}

}  // namespace orchard::pose
