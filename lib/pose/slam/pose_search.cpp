// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/pose_search.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/pose2.hpp"

namespace orchard::pose {
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

}  // namespace orchard::pose
