// SPDX-License-Identifier: BSD-3-Clause
#include "system/real_recordings/return_consistency.hpp"
#include "geometry/pose2.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "pose/motion.hpp"

namespace orchard::test {
namespace {

constexpr double kCell_m = 0.05;
constexpr int kKernelCells = 3;          // 1-sigma
constexpr double kSaturation = 30.0;     // returns at which a place counts half: many are no more
constexpr double kLateSaturation = 2.0;  // than there is
constexpr double kReach_m = 3.0;
constexpr double kTurn_rad = 0.6;
constexpr double kMinOverlap = 0.3;

using Points = std::vector<Eigen::Vector2d>;
using Cell = std::pair<int, int>;

Cell cell_of(const Eigen::Vector2d& p) {
  return {static_cast<int>(std::floor(p.x() / kCell_m)),
          static_cast<int>(std::floor(p.y() / kCell_m))};
}

std::map<Cell, double> counts(const Points& points) {
  std::map<Cell, double> cells;
  for (const Eigen::Vector2d& p : points) cells[cell_of(p)] += 1.0;
  return cells;
}

/// Where the first returns lie, from 0 to 1, on a flat raster.
class Raster {
 public:
  explicit Raster(const Points& points) {
    const int margin = 3 * kKernelCells;
    const std::map<Cell, double> cells = counts(points);
    Cell high = low_ = cells.begin()->first;
    for (const auto& cell : cells) {
      low_ = {std::min(low_.first, cell.first.first), std::min(low_.second, cell.first.second)};
      high = {std::max(high.first, cell.first.first), std::max(high.second, cell.first.second)};
    }
    low_ = {low_.first - margin, low_.second - margin};
    width_ = high.first + margin - low_.first + 1;
    height_ = high.second + margin - low_.second + 1;
    values_.assign(static_cast<std::size_t>(width_) * height_, 0.0);
    for (const auto& [cell, count] : cells) {
      for (int u = -margin; u <= margin; ++u) {
        for (int v = -margin; v <= margin; ++v) {
          const double weight = std::exp(-0.5 * (u * u + v * v) / (kKernelCells * kKernelCells));
          values_[index(cell.first + u - low_.first, cell.second + v - low_.second)] +=
              count * weight;
        }
      }
    }
    for (double& value : values_) value /= value + kSaturation;
  }

  double at(const Eigen::Vector2d& p) const {
    const Cell cell = cell_of(p);
    const int x = cell.first - low_.first, y = cell.second - low_.second;
    return x < 0 || y < 0 || x >= width_ || y >= height_ ? 0.0 : values_[index(x, y)];
  }

 private:
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * width_ + x; }

  Cell low_;
  int width_ = 0, height_ = 0;
  std::vector<double> values_;
};

void add_returns(const laser::Scan& scan, const std::vector<pose::PoseEstimate>& trajectory,
                 const laser::LaserConfig& mount, Points& points) {
  auto at = std::lower_bound(
      trajectory.begin(), trajectory.end(), scan.utime,
      [](const pose::PoseEstimate& pose, std::int64_t utime) { return pose.utime < utime; });
  if (at == trajectory.end()) --at;
  const Eigen::Vector3d T_map_laser =
      geometry::compose(Eigen::Vector3d(at->x_m, at->y_m, at->yaw_rad),
                        Eigen::Vector3d(mount.mount_x_m, mount.mount_y_m, mount.mount_yaw_rad));
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double range_m = scan.ranges_m[i];
    if (!(range_m > scan.range_min_m) || range_m >= scan.range_max_m) continue;
    const double bearing_rad = scan.bearing_rad(static_cast<double>(i));
    points.push_back(geometry::transform(
        T_map_laser, {range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad)}));
  }
}

}  // namespace

std::optional<ReturnConsistency> return_consistency(
    const std::vector<io::SensorMessage>& recording,
    const std::vector<pose::PoseEstimate>& trajectory, const laser::LaserConfig& mount,
    double window_s) {
  std::vector<const laser::Scan*> scans;
  for (const io::SensorMessage& message : recording) {
    if (const auto* scan = std::get_if<laser::Scan>(&message)) scans.push_back(scan);
  }
  if (scans.empty() || trajectory.empty()) return std::nullopt;
  Points first, last;
  for (const laser::Scan* scan : scans) {
    if ((scan->utime - scans.front()->utime) * 1e-6 < window_s) {
      add_returns(*scan, trajectory, mount, first);
    } else if ((scans.back()->utime - scan->utime) * 1e-6 < window_s) {
      add_returns(*scan, trajectory, mount, last);
    }
  }
  if (first.empty() || last.empty()) return std::nullopt;
  const Raster raster(first);
  std::vector<std::pair<Eigen::Vector2d, double>> late;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  double total = 0.0;
  for (const auto& [cell, count] : counts(last)) {
    late.emplace_back(Eigen::Vector2d((cell.first + 0.5) * kCell_m, (cell.second + 0.5) * kCell_m),
                      count / (count + kLateSaturation));
    middle += late.back().first;
    total += late.back().second;
  }
  middle /= static_cast<double>(late.size());
  const auto overlap = [&](const Eigen::Vector3d& shift) {
    const Eigen::Matrix2d R = geometry::rotation(shift.z());
    const Eigen::Vector2d to = middle + shift.head<2>();
    double sum = 0.0;
    for (const auto& [p, weight] : late) sum += weight * raster.at(to + R * (p - middle));
    return sum / total;
  };

  ReturnConsistency result;
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  result.overlap = result.best_overlap = overlap(best);
  const auto take_if_better = [&](const Eigen::Vector3d& shift) {
    const double value = overlap(shift);
    if (value <= result.best_overlap) return false;
    result.best_overlap = value;
    best = shift;
    return true;
  };
  const double step_m = 0.15, step_rad = 0.06;
  const int reach = static_cast<int>(std::lround(kReach_m / step_m));
  const int turns = static_cast<int>(std::lround(kTurn_rad / step_rad));
  for (int a = -turns; a <= turns; ++a) {
    for (int x = -reach; x <= reach; ++x) {
      for (int y = -reach; y <= reach; ++y) {
        take_if_better({x * step_m, y * step_m, a * step_rad});
      }
    }
  }
  for (double size = 0.5; size > 0.05; size *= 0.5) {
    for (bool better = true; better;) {
      better = false;
      for (int k = 0; k < 3; ++k) {
        for (const double sign : {-1.0, 1.0}) {
          Eigen::Vector3d shift = best;
          shift[k] += sign * size * (k == 2 ? step_rad : step_m);
          better = take_if_better(shift) || better;
        }
      }
    }
  }
  if (result.best_overlap < kMinOverlap) return std::nullopt;
  result.shift_m = best.head<2>().norm();
  result.turn_rad = best.z();
  return result;
}

std::vector<pose::PoseEstimate> dead_reckoned(const std::vector<io::SensorMessage>& recording) {
  std::vector<pose::PoseEstimate> path;
  Eigen::Vector3d T_map_base = Eigen::Vector3d::Zero();
  const pose::Odometry* before = nullptr;
  for (const io::SensorMessage& message : recording) {
    const auto* now = std::get_if<pose::Odometry>(&message);
    if (now == nullptr) continue;
    if (before != nullptr) {
      T_map_base = geometry::compose(
          T_map_base, pose::arc_motion(0.5 * (before->speed_mps + now->speed_mps),
                                       0.5 * (before->yaw_rate_radps + now->yaw_rate_radps),
                                       (now->utime - before->utime) * 1e-6));
    }
    before = now;
    pose::PoseEstimate pose;
    pose.utime = now->utime;
    pose.x_m = T_map_base.x();
    pose.y_m = T_map_base.y();
    pose.yaw_rad = T_map_base.z();
    path.push_back(pose);
  }
  return path;
}

}  // namespace orchard::test
