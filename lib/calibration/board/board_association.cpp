// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/board/board_association.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::calibration {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double kGrid_rad = 0.21;          ///< 12 degrees
constexpr double kDirectionGate = 0.25;     ///< limit of n . R l on the grid
constexpr int kMaxStarts = 60;              ///< number of rotations to refine
constexpr double kWideGate_m = 0.30;        ///< initial gate of a line's distance from the board
constexpr double kGate_m = 0.04;            ///< final gate
constexpr double kMinRivalGate_m = 0.01;    ///< lower limit of the gate for rivals
constexpr double kOutsideBoard_m = 0.06;    ///< max distance of a line's middle outside the board
constexpr double kSameRotation_rad = 0.17;  ///< mounts closer than this are the same
constexpr double kSameShift_m = 0.10;

Eigen::Vector3d in_space(const Eigen::Vector2d& p) { return {p.x(), p.y(), 0.0}; }

std::vector<Eigen::Matrix3d> all_rotations() {
  std::vector<Eigen::Matrix3d> rotations;
  const int num_axes = static_cast<int>(4.0 * geometry::kPi / (kGrid_rad * kGrid_rad));
  const int num_turns = static_cast<int>(2.0 * geometry::kPi / kGrid_rad) + 1;
  const double golden = geometry::kPi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < num_axes; ++i) {  // Fibonacci sphere
    const double z = 1.0 - (2.0 * i + 1.0) / num_axes;
    const double r = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d axis(r * std::cos(golden * i), r * std::sin(golden * i), z);
    const Eigen::Quaterniond to_axis =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), axis);
    for (int k = 0; k < num_turns; ++k) {
      const Eigen::AngleAxisd turn(2.0 * geometry::kPi * k / num_turns, Eigen::Vector3d::UnitZ());
      rotations.push_back((to_axis * turn).toRotationMatrix());
    }
  }
  return rotations;
}

double angle_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return Eigen::AngleAxisd(a.transpose() * b).angle();
}

struct Plane {
  Eigen::Vector3d normal;
  double distance_m;
};

class Matcher {
 public:
  Matcher(const std::vector<ExtrinsicsView>& views, const BoardOutline& outline)
      : views_(views), outline_(outline) {
    for (const ExtrinsicsView& view : views) {
      planes_.push_back({view.board.normal_camera(), view.board.distance_m()});
    }
  }

  /// Cost of a rotation by the directions of the lines: 0 is perfect; 1 per view without a fit.
  double direction_cost(const Eigen::Matrix3d& R) const {
    double cost = 0.0;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      double least = 1.0;
      const Eigen::Vector3d n_laser = R.transpose() * planes_[i].normal;
      for (const BoardLine& line : views_[i].lines) {
        const double off = n_laser.head<2>().dot(line.direction) / kDirectionGate;
        least = std::min(least, off * off);
      }
      cost += least;
    }
    return cost;
  }

  RigidExtrinsics refine(const Eigen::Matrix3d& start) const {
    RigidExtrinsics mount;
    mount.R_camera_laser = start;
    double gate_m = kWideGate_m;
    for (int round = 0; round < 4; ++round) mount = step(mount, 1e3, true);
    for (int round = 0; round < 24; ++round) {
      mount = step(mount, gate_m, false);
      gate_m = std::max(kGate_m, 0.85 * gate_m);
    }
    return mount;
  }

  struct Match {
    int line = -1;
    double off_m = 1e9;
  };

  /// Finds the line of a view that is nearest to the plane of its board.
  Match nearest(std::size_t i, const RigidExtrinsics& mount, bool direction_only) const {
    Match best;
    for (std::size_t j = 0; j < views_[i].lines.size(); ++j) {
      const double off_m = off(i, mount, views_[i].lines[j], direction_only);
      if (off_m < best.off_m) best = {static_cast<int>(j), off_m};
    }
    return best;
  }

  bool on_board(std::size_t i, const RigidExtrinsics& mount, const BoardLine& line) const {
    const BoardPose& board = views_[i].board;
    const Eigen::Vector3d p =
        board.R_camera_board.transpose() *
        (mount.R_camera_laser * in_space(line.middle_m) + mount.delta_m - board.t_camera_board_m);
    return p.x() > outline_.x_min_m - kOutsideBoard_m &&
           p.x() < outline_.x_max_m + kOutsideBoard_m &&
           p.y() > outline_.y_min_m - kOutsideBoard_m && p.y() < outline_.y_max_m + kOutsideBoard_m;
  }

  /// Fills `out` with the lines within `gate_m` and returns the cost; 1 per view without a line.
  double judge(const RigidExtrinsics& mount, double gate_m, Association& out) const {
    out.mount = mount;
    out.line_of_view.assign(views_.size(), -1);
    out.num_fitting = 0;
    double cost = 0.0;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      Match best;
      for (std::size_t j = 0; j < views_[i].lines.size(); ++j) {
        const BoardLine& line = views_[i].lines[j];
        const double off_m = off(i, mount, line, false);
        if (off_m < best.off_m && off_m < gate_m && on_board(i, mount, line)) {
          best = {static_cast<int>(j), off_m};
        }
      }
      if (best.line < 0) {
        cost += 1.0;
        continue;
      }
      cost += best.off_m * best.off_m / (gate_m * gate_m);
      out.line_of_view[i] = best.line;
      ++out.num_fitting;
    }
    return cost;
  }

 private:
  double off(std::size_t i, const RigidExtrinsics& mount, const BoardLine& line,
             bool direction_only) const {
    const Eigen::Vector3d& n = planes_[i].normal;
    const double turn = n.dot(mount.R_camera_laser * in_space(line.direction));
    const double across_m = 0.5 * line.length_m * turn;
    if (direction_only) return std::abs(across_m);
    const double along_m = n.dot(mount.R_camera_laser * in_space(line.middle_m) + mount.delta_m) -
                           planes_[i].distance_m;
    return std::hypot(across_m, along_m);
  }

  /// One reweighted Gauss-Newton step (Cauchy weights) with the nearest line of each view.
  RigidExtrinsics step(const RigidExtrinsics& mount, double gate_m, bool direction_only) const {
    Matrix6 normal = Matrix6::Zero();
    Vector6 gradient = Vector6::Zero();
    for (std::size_t i = 0; i < views_.size(); ++i) {
      const Match match = nearest(i, mount, direction_only);
      if (match.line < 0) continue;
      const BoardLine& line = views_[i].lines[static_cast<std::size_t>(match.line)];
      const double scaled = match.off_m / gate_m;
      const double weight = 1.0 / (1.0 + scaled * scaled);
      const Eigen::Vector3d& n = planes_[i].normal;
      const Eigen::Vector3d l = mount.R_camera_laser * in_space(line.direction);
      const Eigen::Vector3d p = mount.R_camera_laser * in_space(line.middle_m);
      const double half_m = 0.5 * line.length_m;
      Vector6 row;  // d / d(delta, turn)
      row << Eigen::Vector3d::Zero(), half_m * l.cross(n);
      double error_m = half_m * n.dot(l);
      normal += weight * row * row.transpose();
      gradient += weight * error_m * row;
      // Adjust the translation to the rotation from the start, independent of the gate.
      row << n, direction_only ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : p.cross(n);
      error_m = n.dot(p + mount.delta_m) - planes_[i].distance_m;
      const double position_weight = direction_only ? 1.0 / (1.0 + std::abs(error_m)) : weight;
      normal += position_weight * row * row.transpose();
      gradient += position_weight * error_m * row;
    }
    // Regularisation: directions that the views do not determine stay unchanged.
    normal.diagonal().array() += 1e-5;
    Vector6 change = -normal.ldlt().solve(gradient);
    const double turn = change.tail<3>().norm();
    if (turn > 0.3) change *= 0.3 / turn;
    RigidExtrinsics next = mount;
    next.delta_m += change.head<3>();
    const double angle = change.tail<3>().norm();
    if (angle > 1e-12) {
      next.R_camera_laser = Eigen::AngleAxisd(angle, change.tail<3>() / angle).toRotationMatrix() *
                            mount.R_camera_laser;
    }
    return next;
  }

  const std::vector<ExtrinsicsView>& views_;
  const BoardOutline& outline_;
  std::vector<Plane> planes_;
};

bool same_mount(const RigidExtrinsics& a, const RigidExtrinsics& b) {
  return angle_between(a.R_camera_laser, b.R_camera_laser) < kSameRotation_rad &&
         (a.delta_m - b.delta_m).norm() < kSameShift_m;
}

}  // namespace

Association associate_board_lines(const std::vector<ExtrinsicsView>& views,
                                  const BoardOutline& outline) {
  const Matcher matcher(views, outline);
  struct Start {
    double cost;
    Eigen::Matrix3d R;
  };
  std::vector<Start> starts;
  for (const Eigen::Matrix3d& R : all_rotations()) starts.push_back({matcher.direction_cost(R), R});
  std::stable_sort(starts.begin(), starts.end(),
                   [](const Start& a, const Start& b) { return a.cost < b.cost; });

  std::vector<Eigen::Matrix3d> tried;
  Association best;
  best.line_of_view.assign(views.size(), -1);
  double best_cost = 1e18;
  std::vector<RigidExtrinsics> all;
  for (const Start& start : starts) {
    if (static_cast<int>(tried.size()) >= kMaxStarts) break;
    const bool near = std::any_of(tried.begin(), tried.end(), [&](const Eigen::Matrix3d& R) {
      return angle_between(R, start.R) < 0.9 * kGrid_rad;
    });
    if (near) continue;
    tried.push_back(start.R);
    Association found;
    const double cost = matcher.judge(matcher.refine(start.R), kGate_m, found);
    all.push_back(found.mount);
    if (cost < best_cost) {
      best_cost = cost;
      best = std::move(found);
    }
  }
  // A rival explains the views equally well only if its lines are as close to the boards.
  const double num_missing = static_cast<double>(views.size()) - best.num_fitting;
  const double best_rms_m =
      kGate_m * std::sqrt(std::max(0.0, best_cost - num_missing) / std::max(1, best.num_fitting));
  const double rival_gate_m = std::clamp(3.0 * best_rms_m, kMinRivalGate_m, kGate_m);
  for (const RigidExtrinsics& mount : all) {
    if (same_mount(mount, best.mount)) continue;
    Association rival;
    matcher.judge(mount, rival_gate_m, rival);
    best.rival_fitting = std::max(best.rival_fitting, rival.num_fitting);
  }
  return best;
}

}  // namespace orchard::calibration
