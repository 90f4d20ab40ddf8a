// SPDX-License-Identifier: BSD-3-Clause
#include "pose/attitude/ground_profile.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"
#include "timing/units.hpp"

namespace orchard::pose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using geometry::square;

// derived: a robot that is not located for longer may have been carried.
constexpr double kCarried_s = 10.0;
// physical: a filter's tilt errs alike for about half a minute, at a walking pace.
constexpr double kTiltErrorLength_m = 30.0;
// physical: slopes along a path change within some trees.
constexpr double kSlopeLength_m = 10.0;
// physical: wheels sink into soil and climb over clods of some centimetres.
constexpr double kUnevenSd_m = 0.02;
// physical: of a fix's error about half is that of its neighbours: orbits, air, and multipath.
constexpr double kSharedOfFix = 0.5;
// derived: Gaussian residuals pass it once in 400; the weights settle within the rounds.
constexpr double kOutlierSigmas = 3.0;
constexpr int kRounds = 4;

/// What was read within a metre of the path.
struct Cell {
  Vector2d p_map = Vector2d::Zero();     ///< the mean of the fixes, else of all readings
  Vector2d gradient = Vector2d::Zero();  ///< the mean by the tilts, in map
  double yaw_rad = 0.0, tilt_sd_rad = 0.0;
  double height_m = 0.0, variance_m2 = 0.0;  ///< of the ground by the fixes; 0 = none
  int num_readings = 0, num_tilts = 0, num_fixes = 0;
  bool begins = false;  ///< a stretch that no way links to the one before

  bool has_tilt() const { return num_tilts > 0; }
};

void add(const GroundReading& r, const Vector3d& p_base_antenna_m, Cell& cell) {
  const auto mean = [](auto& value, const auto& next, int num) { value += (next - value) / num; };
  if (++cell.num_readings == 1) cell.yaw_rad = r.yaw_rad;
  const bool has_fix = r.antenna_variance_m2 > 0.0;
  cell.num_fixes += has_fix;
  if (has_fix || cell.num_fixes == 0) {  // where the height holds, if there is one
    const int num = has_fix ? cell.num_fixes : cell.num_readings;
    mean(cell.p_map, Vector2d(r.x_m, r.y_m), num);
  }
  if (r.tilt) {
    ++cell.num_tilts;
    const Vector2d seen = geometry::rotation(r.yaw_rad) * gradient_under(*r.tilt);
    mean(cell.gradient, seen, cell.num_tilts);
    mean(cell.tilt_sd_rad, r.tilt->sd_rad, cell.num_tilts);
  }
  if (has_fix) {
    const Vector3d lever_m = R_level_base(r.tilt.value_or(Attitude{})) * p_base_antenna_m;
    mean(cell.height_m, r.antenna_height_m - lever_m.z(), cell.num_fixes);
    mean(cell.variance_m2, r.antenna_variance_m2, cell.num_fixes);
  }
}

std::vector<Cell> cells_of(const std::vector<GroundReading>& readings, const Vector3d& antenna_m) {
  std::vector<Cell> cells;
  const GroundReading* first = nullptr;  // of the newest cell
  const GroundReading* last = nullptr;
  for (const GroundReading& r : readings) {
    const auto from_m = [&r](const GroundReading& o) {
      return std::hypot(r.x_m - o.x_m, r.y_m - o.y_m);
    };
    const bool is_linked =
        last != nullptr &&
        (timing::seconds(r.utime - last->utime) < kCarried_s || from_m(*last) < kBody_m);
    if (!is_linked || from_m(*first) >= kBody_m) {
      cells.emplace_back().begins = !is_linked;
      first = &r;
    }
    add(r, antenna_m, cells.back());
    last = &r;
  }
  return cells;
}

/// The height of the ground, and what is added to the slope told by the tilt: its error along
/// base's axes; where no tilt is known the whole slope, along those of map.
struct State {
  Vector3d mean = Vector3d::Zero();
  Matrix3d covariance = Matrix3d::Zero();
};

double slope_variance(const Cell& cell) {
  return cell.has_tilt() ? square(kMountSd_rad) + square(cell.tilt_sd_rad) : square(kDrivenSlopeSd);
}

State start(const Cell& cell) {
  constexpr double kAnyHeight_m = 1e5;  // derived: above all altitudes
  State state;
  state.covariance.diagonal() << square(kAnyHeight_m), slope_variance(cell), slope_variance(cell);
  return state;
}

/// The step from one cell to the next: x' = A x + u + noise.
struct Step {
  Matrix3d A = Matrix3d::Identity();
  Vector3d u = Vector3d::Zero();
  Matrix3d noise = Matrix3d::Zero();
};

Step step_between(const Cell& from, const Cell& to) {
  Step step;
  const Vector2d way_m = to.p_map - from.p_map;
  const double length_m = way_m.norm();
  const bool is_same = from.has_tilt() == to.has_tilt();
  const double memory_m = from.has_tilt() ? kTiltErrorLength_m : kSlopeLength_m;
  const double kept = is_same ? std::exp(-length_m / memory_m) : 0.0;
  if (from.has_tilt()) {
    const Vector2d told = to.has_tilt() ? 0.5 * (from.gradient + to.gradient) : from.gradient;
    step.u(0) = told.dot(way_m);
    step.A.block<1, 2>(0, 1) = (geometry::rotation(-from.yaw_rad) * way_m).transpose();
  } else {
    step.A.block<1, 2>(0, 1) = way_m.transpose();
  }
  step.A.block<2, 2>(1, 1) *= kept;
  const double renewed = slope_variance(to) * (1.0 - kept * kept);
  step.noise.diagonal() << square(kUnevenSd_m) * length_m, renewed, renewed;
  return step;
}

void correct(const Cell& cell, double variance_m2, State& state) {
  if (cell.num_fixes == 0) return;
  const Vector3d gain = state.covariance.col(0) / (state.covariance(0, 0) + variance_m2);
  state.mean += gain * (cell.height_m - state.mean(0));
  state.covariance -= gain * state.covariance.row(0).eval();
}

/// Rauch, Tung and Striebel: forwards by a Kalman filter, then what is known later backwards.
std::vector<State> smoothed(const std::vector<Cell>& cells, const std::vector<double>& variances) {
  std::vector<State> states(cells.size()), predicted(cells.size());
  std::vector<Step> steps(cells.size());
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (cells[k].begins) {
      predicted[k] = start(cells[k]);
    } else {
      const Step& s = steps[k] = step_between(cells[k - 1], cells[k]);
      predicted[k].mean = s.A * states[k - 1].mean + s.u;
      predicted[k].covariance = s.A * states[k - 1].covariance * s.A.transpose() + s.noise;
    }
    states[k] = predicted[k];
    correct(cells[k], variances[k], states[k]);
  }
  for (std::size_t k = cells.size(); k-- > 1;) {
    if (cells[k].begins) continue;
    State& before = states[k - 1];
    const Matrix3d G =
        predicted[k].covariance.ldlt().solve(steps[k].A * before.covariance).transpose();
    before.mean += G * (states[k].mean - predicted[k].mean);
    before.covariance += G * (states[k].covariance - predicted[k].covariance) * G.transpose();
  }
  return states;
}

}  // namespace

GroundProfile ground_along(const std::vector<GroundReading>& readings,
                           const Vector3d& p_base_antenna_m) {
  const std::vector<Cell> cells = cells_of(readings, p_base_antenna_m);
  std::vector<double> variances;
  double information = 0.0;
  int num_fixed = 0;
  for (const Cell& cell : cells) {
    variances.push_back(cell.variance_m2);
    if (cell.num_fixes == 0) continue;
    information += 1.0 / cell.variance_m2;
    ++num_fixed;
  }
  GroundProfile profile;
  if (num_fixed == 0) return profile;
  profile.shared_variance_m2 = kSharedOfFix * num_fixed / information;
  std::vector<State> states;
  for (int round = 0; round < kRounds; ++round) {
    states = smoothed(cells, variances);
    for (std::size_t k = 0; k < cells.size(); ++k) {  // Huber's weights
      const double off_m = std::abs(cells[k].height_m - states[k].mean(0));
      const double most_m = kOutlierSigmas * std::sqrt(cells[k].variance_m2);
      variances[k] = cells[k].variance_m2 * (off_m > most_m ? off_m / most_m : 1.0);
    }
  }
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const Cell& cell = cells[k];
    const Vector2d error = states[k].mean.tail<2>();
    GroundPoint& point = profile.points.emplace_back();
    point.x_m = cell.p_map.x(), point.y_m = cell.p_map.y();
    point.z_m = states[k].mean(0);
    point.variance_m2 = std::max(0.0, states[k].covariance(0, 0));
    if (cell.has_tilt()) point.gradient = cell.gradient + geometry::rotation(cell.yaw_rad) * error;
  }
  return profile;
}

}  // namespace orchard::pose
