// SPDX-License-Identifier: BSD-3-Clause
#include "pose/attitude/ground_profile.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"
#include "timing/units.hpp"

namespace orchard::pose {
namespace {

using Eigen::Matrix4d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector4d;
using geometry::square;

// derived: a robot that is not located for longer may have been carried.
constexpr double kCarried_s = 10.0;
// derived: Gaussian residuals pass it once in 400; the weights settle within the rounds.
constexpr double kOutlierSigmas = 3.0;
constexpr int kRounds = 4;

/// What is not known beforehand of a receiver, a unit and a ground: those values under which the
/// fixes of the drive are likeliest. They begin with the most cautious.
struct Model {
  double own_share = 0.05;   ///< of a fix's variance; the rest is that of its neighbours, too
  double shared_s = 1000.0;  ///< in which that changes
  double memory_m = 1.0;   ///< over which the error of the tilt is one, or where unknown the slope
  double uneven_m = 0.08;  ///< what a metre adds to heights beside a slope that no tilt tells
};
// derived: a factor of three in a time or length is about what one drive tells: from some fixes to
// a quarter of an hour, from a body's length to that of a row and more.
constexpr std::array kOwnShares{0.05, 0.2, 0.4, 0.6, 0.8, 1.0};
constexpr std::array kShared_s{1000.0, 300.0, 100.0, 30.0, 10.0};
constexpr std::array kUneven_m{0.08, 0.04, 0.02, 0.01, 0.005};
constexpr std::array kMemory_m{1.0, 3.0, 10.0, 30.0, 100.0, 300.0};

/// What was read within a metre of the path.
struct Cell {
  Vector2d p_map = Vector2d::Zero();     ///< the mean of the fixes, else of all readings
  Vector2d gradient = Vector2d::Zero();  ///< the mean by the tilts, in map
  double yaw_rad = 0.0, tilt_sd_rad = 0.0;
  double height_m = 0.0, variance_m2 = 0.0;  ///< of the ground by the fixes; 0 = none
  int num_readings = 0, num_tilts = 0, num_fixes = 0;
  std::int64_t utime = 0;
  double weight = 1.0;  ///< of the fixes
  bool begins = false;  ///< a stretch that no way links to the one before

  bool has_tilt() const { return num_tilts > 0; }
};

void add(const GroundReading& r, const Vector3d& p_base_antenna_m, Cell& cell) {
  const auto mean = [](auto& value, const auto& next, int num) { value += (next - value) / num; };
  if (++cell.num_readings == 1) cell.yaw_rad = r.yaw_rad, cell.utime = r.utime;
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

/// The height of the ground; what is added to the slope told by the tilt: its error along base's
/// axes, where no tilt is known the whole slope, along those of map; and the error that neighbours
/// among the fixes share, in standard deviations.
struct State {
  Vector4d mean = Vector4d::Zero();
  Matrix4d covariance = Matrix4d::Zero();
};

double slope_variance(const Cell& cell) {
  return cell.has_tilt() ? square(kMountSd_rad) + square(cell.tilt_sd_rad) : square(kDrivenSlopeSd);
}

State start(const Cell& cell) {
  constexpr double kAnyHeight_m = 1e5;  // derived: above all altitudes
  State state;
  const double slope = slope_variance(cell);
  state.covariance.diagonal() << square(kAnyHeight_m), slope, slope, 1.0;
  return state;
}

/// The step from one cell to the next: x' = A x + u + noise.
struct Step {
  Matrix4d A = Matrix4d::Identity();
  double rise_m = 0.0;
  Vector4d noise = Vector4d::Zero();
};

Step step_between(const Cell& from, const Cell& to, const Model& model) {
  Step step;
  const Vector2d way_m = to.p_map - from.p_map;
  const double length_m = way_m.norm();
  const bool is_same = from.has_tilt() == to.has_tilt();
  const double kept = is_same ? std::exp(-length_m / model.memory_m) : 0.0;
  const double shared = std::exp(-timing::seconds(to.utime - from.utime) / model.shared_s);
  if (from.has_tilt()) {
    const Vector2d told = to.has_tilt() ? 0.5 * (from.gradient + to.gradient) : from.gradient;
    step.rise_m = told.dot(way_m);
    step.A.block<1, 2>(0, 1) = (geometry::rotation(-from.yaw_rad) * way_m).transpose();
  } else {
    step.A.block<1, 2>(0, 1) = way_m.transpose();
  }
  step.A.block<2, 2>(1, 1) *= kept;
  step.A(3, 3) = shared;
  const double renewed = slope_variance(to) * (1.0 - kept * kept);
  const bool is_told = from.has_tilt() && to.has_tilt();
  step.noise << (is_told ? 0.0 : square(model.uneven_m) * length_m), renewed, renewed,
      1.0 - square(shared);
  return step;
}

/// Variance of the mean of a cell's fixes that its neighbours do not share.
double own_variance_m2(const Cell& cell, const Model& model) {
  return model.own_share * cell.variance_m2 / (cell.num_fixes * cell.weight);
}

/// Corrects by the fixes of a cell. Returns minus twice the logarithm of their likelihood, that of
/// Huber: an outlier has no say in the choice of a model.
double correct(const Cell& cell, const Model& model, State& state) {
  if (cell.num_fixes == 0) return 0.0;
  const double own_m2 = own_variance_m2(cell, model);
  const Vector4d H(1.0, 0.0, 0.0, std::sqrt((1.0 - model.own_share) * cell.variance_m2));
  const Vector4d covariance = state.covariance * H;
  const double variance_m2 = H.dot(covariance) + own_m2;
  const double off_m = cell.height_m - H.dot(state.mean);
  state.mean += covariance * (off_m / variance_m2);
  state.covariance -= covariance * covariance.transpose() / variance_m2;
  const double off = std::abs(off_m) / std::sqrt(variance_m2);
  const double off2 =
      off < kOutlierSigmas ? off * off : kOutlierSigmas * (2 * off - kOutlierSigmas);
  return std::log(variance_m2) + off2;
}

/// A Kalman filter along the path. `note` gets the step to each cell, what was expected there and
/// what is known with its fixes. Returns how unlikely the fixes are (correct()).
template <class Note>
double filter(const std::vector<Cell>& cells, const Model& model, const Note& note) {
  State state;
  double unlikely = 0.0;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    Step step;
    if (cells[k].begins) {
      state = start(cells[k]);
    } else {
      step = step_between(cells[k - 1], cells[k], model);
      state.mean = step.A * state.mean;
      state.mean(0) += step.rise_m;
      state.covariance = step.A * state.covariance * step.A.transpose();
      state.covariance.diagonal() += step.noise;
    }
    const State expected = state;
    unlikely += correct(cells[k], model, state);
    note(step, expected, state);
  }
  return unlikely;
}

double unlikely_under(const Model& model, const std::vector<Cell>& cells) {
  return filter(cells, model, [](const Step&, const State&, const State&) {});
}

/// Rauch, Tung and Striebel: forwards by a Kalman filter, then what is known later backwards.
std::vector<State> smoothed(const std::vector<Cell>& cells, const Model& model) {
  std::vector<Step> steps;
  std::vector<State> expected, known;
  filter(cells, model, [&](const Step& step, const State& before, const State& after) {
    steps.push_back(step), expected.push_back(before), known.push_back(after);
  });
  for (std::size_t k = cells.size(); k-- > 1;) {
    if (cells[k].begins) continue;
    State& before = known[k - 1];
    const Matrix4d G =
        expected[k].covariance.ldlt().solve(steps[k].A * before.covariance).transpose();
    before.mean += G * (known[k].mean - expected[k].mean);
    before.covariance += G * (known[k].covariance - expected[k].covariance) * G.transpose();
  }
  return known;
}

/// The likeliest model, one of its values after the other.
Model likelier(const std::vector<Cell>& cells, Model model) {
  double least = unlikely_under(model, cells);
  const auto choose = [&](double Model::*value, const auto& candidates) {
    for (const double candidate : candidates) {
      Model other = model;
      other.*value = candidate;
      const double unlikely = unlikely_under(other, cells);
      if (unlikely < least) least = unlikely, model = other;
    }
  };
  choose(&Model::own_share, kOwnShares);
  choose(&Model::shared_s, kShared_s);
  choose(&Model::uneven_m, kUneven_m);
  choose(&Model::memory_m, kMemory_m);
  return model;
}

}  // namespace

GroundProfile ground_along(const std::vector<GroundReading>& readings,
                           const Vector3d& p_base_antenna_m) {
  std::vector<Cell> cells = cells_of(readings, p_base_antenna_m);
  const auto has_fix = [](const Cell& cell) { return cell.num_fixes > 0; };
  if (std::none_of(cells.begin(), cells.end(), has_fix)) return {};
  Model model;
  std::vector<State> states;
  for (int round = 0; round < kRounds; ++round) {
    model = likelier(cells, model);
    states = smoothed(cells, model);
    for (std::size_t k = 0; k < cells.size(); ++k) {  // Huber's weights
      const double off_m = std::abs(cells[k].height_m - states[k].mean(0));
      const double most_m = kOutlierSigmas * std::sqrt(cells[k].variance_m2);
      cells[k].weight = off_m > most_m ? most_m / off_m : 1.0;
    }
  }
  GroundProfile profile;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const Cell& cell = cells[k];
    GroundPoint& point = profile.emplace_back();
    point.x_m = cell.p_map.x(), point.y_m = cell.p_map.y(), point.yaw_rad = cell.yaw_rad;
    point.z_m = states[k].mean(0);
    point.variance_m2 = std::max(0.0, states[k].covariance(0, 0));
    if (!cell.has_tilt()) {
      if (cell.num_fixes > 0) {
        // Smoothed heights would look like smooth ground to what weighs its roughness.
        const double shared_m2 = (1.0 - model.own_share) * cell.variance_m2;
        point.z_m = cell.height_m - std::sqrt(shared_m2) * states[k].mean(3);
        point.variance_m2 = shared_m2 * states[k].covariance(3, 3);
        point.own_variance_m2 = own_variance_m2(cell, model);
      }
      // An antenna h above a slope g is h g^2 / 2 lower than upright, and h g downhill of its
      // robot, where the ground is h g^2 lower.
      const double slope2 = states[k].mean.segment<2>(1).squaredNorm() +
                            states[k].covariance.block<2, 2>(1, 1).trace();
      point.variance_m2 += square(0.5 * p_base_antenna_m.z() * slope2);
      continue;
    }
    const Vector2d error = states[k].mean.segment<2>(1);
    point.gradient = cell.gradient + geometry::rotation(cell.yaw_rad) * error;
    point.slope_variance = std::max(0.0, states[k].covariance(2, 2));
  }
  return profile;
}

}  // namespace orchard::pose
