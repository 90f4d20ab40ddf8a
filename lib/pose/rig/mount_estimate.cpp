// SPDX-License-Identifier: BSD-3-Clause
#include "pose/rig/mount_estimate.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"

namespace orchard::pose {
namespace {

using geometry::rotation;
using geometry::square;

/// derived: three equations a motion, seven unknowns; below this a robust scale says little.
constexpr std::size_t kMotionsMin = 20;
/// derived: the error halves at least in each round.
constexpr int kMountRounds = 20;
/// derived: both at 95 % of the efficiency of least squares. Huber's weight first, by which every
/// motion still pulls: the turns, which alone tell the mount, lie far off until it is found. Beyond
/// Tukey's, in the last rounds, a motion has no say.
constexpr double kHuber = 1.345;
constexpr double kTukey = 4.685;
constexpr int kHuberRounds = 15;

// physical: what is known of a rig before it drives. Scanners sit on their robot, wheels are known
// to a third, clocks of one computer to half a second.
constexpr double kMountSd_m = 2.0;
constexpr double kScaleSd = 0.3;
constexpr double kRateBiasSd_radps = 0.02;
constexpr double kLagSd_s = 0.5;
// physical: no scan matching is better than this, so that a perfect fit does not claim to be exact.
constexpr double kTurnFloor_rad = 5e-4;
constexpr double kWayFloor_m = 1e-3;

/// derived: an error of matching turns about what is seen, and so looks like a mount there; of a
/// turn this many errors large it is 4 % (1 / (1 + 5^2)). What turns less does not tell the mount.
constexpr double kTurnMin_sigma = 5.0;

/// The unknowns in their order.
enum Unknown { kX, kY, kYaw, kWay, kTurn, kBias, kLag, kNum };
using Unknowns = Eigen::Matrix<double, kNum, 1>;
using Information = Eigen::Matrix<double, kNum, kNum>;
using Jacobian = Eigen::Matrix<double, 3, kNum>;

Eigen::Vector3d mirror_image(const Eigen::Vector3d& motion) {
  return {motion.x(), -motion.y(), -motion.z()};
}

/// Residual (x [m], y [m], yaw [rad]) of a motion and its derivatives.
Eigen::Vector3d residual_of(const MotionPair& pair, const Unknowns& u, Jacobian& J) {
  const double turn_rad = pair.laser.z();
  const double lag_s = u(kLag);
  const Eigen::Vector3d reference = pair.reference + lag_s * pair.reference_rate;
  Eigen::Vector3d r;
  r.z() = turn_rad - u(kTurn) * reference.z() - u(kBias) * pair.duration_s;
  // Wheels that turn wrongly also point the way wrongly, on average by half of the error.
  const Eigen::Matrix2d half = rotation(0.5 * (turn_rad - reference.z()));
  const Eigen::Vector2d way = half * reference.head<2>();
  const Eigen::Matrix2d swing = rotation(turn_rad) - Eigen::Matrix2d::Identity();
  const Eigen::Vector2d seen = rotation(u(kYaw)) * pair.laser.head<2>();
  r.head<2>() = swing * u.head<2>() + u(kWay) * way - seen;
  J.setZero();
  J.topLeftCorner<2, 2>() = swing;
  J.block<2, 1>(0, kYaw) = Eigen::Vector2d(seen.y(), -seen.x());
  J.block<2, 1>(0, kWay) = way;
  J.block<2, 1>(0, kLag) = u(kWay) * (half * pair.reference_rate.head<2>());
  J(2, kTurn) = -reference.z();
  J(2, kBias) = -pair.duration_s;
  J(2, kLag) = -u(kTurn) * pair.reference_rate.z();
  return r;
}

double weight_of(double distance_sigma, int round) {
  if (round < kHuberRounds) return distance_sigma > kHuber ? kHuber / distance_sigma : 1.0;
  const double share = distance_sigma / kTukey;
  return share < 1.0 ? square(1.0 - share * share) : 0.0;
}

struct Solution {
  Unknowns u;
  Information covariance = Information::Identity();
  double turn_sd_rad = 0.0;  ///< robust, of the residuals
};

/// Robust standard deviations of the residuals: of the way [m] and the turn [rad].
struct Scatter {
  double way_m = 0.0;
  double turn_rad = 0.0;
};

Scatter scatter_of(const std::vector<MotionPair>& pairs, const Unknowns& u) {
  std::vector<double> ways_m, turns_rad;
  Jacobian J;
  for (const MotionPair& pair : pairs) {
    const Eigen::Vector3d r = residual_of(pair, u, J);
    ways_m.push_back(r.x());
    ways_m.push_back(r.y());
    turns_rad.push_back(r.z());
  }
  return {std::max(kWayFloor_m, geometry::robust_sd(std::move(ways_m))),
          std::max(kTurnFloor_rad, geometry::robust_sd(std::move(turns_rad)))};
}

Unknowns first_guess(const std::vector<MotionPair>& pairs) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const MotionPair& pair : pairs) {
    const Eigen::Vector2d a = pair.laser.head<2>(), b = pair.reference.head<2>();
    sum += Eigen::Vector2d(a.dot(b), a.x() * b.y() - a.y() * b.x());
  }
  Unknowns u = Unknowns::Zero();
  u(kYaw) = std::atan2(sum.y(), sum.x());
  u(kWay) = u(kTurn) = 1.0;
  return u;
}

Solution solve(const std::vector<MotionPair>& pairs) {
  Solution solution;
  Unknowns& u = solution.u;
  u = first_guess(pairs);
  Unknowns prior = Unknowns::Zero(), prior_information;
  prior(kWay) = prior(kTurn) = 1.0;
  prior_information << 1.0 / square(kMountSd_m), 1.0 / square(kMountSd_m), 0.0,
      1.0 / square(kScaleSd), 1.0 / square(kScaleSd), 1.0 / square(kRateBiasSd_radps),
      1.0 / square(kLagSd_s);
  Scatter scatter;
  for (int round = 0; round < kMountRounds; ++round) {
    scatter = scatter_of(pairs, u);
    Information H = prior_information.asDiagonal();
    Unknowns gradient = prior_information.cwiseProduct(u - prior);
    Jacobian J;
    for (const MotionPair& pair : pairs) {
      const Eigen::Vector3d r = residual_of(pair, u, J);
      if (std::abs(pair.laser.z()) < kTurnMin_sigma * scatter.turn_rad) {
        J.leftCols<kYaw>().setZero();
      }
      const double way_sigma = r.head<2>().norm() / scatter.way_m;
      const double turn_sigma = std::abs(r.z()) / scatter.turn_rad;
      const double weight = weight_of(std::max(way_sigma / std::sqrt(2.0), turn_sigma), round);
      const Eigen::Vector3d information =
          weight * Eigen::Vector3d(1.0 / square(scatter.way_m), 1.0 / square(scatter.way_m),
                                   1.0 / square(scatter.turn_rad));
      H += J.transpose() * information.asDiagonal() * J;
      gradient += J.transpose() * information.cwiseProduct(r);
    }
    const Eigen::LDLT<Information> solver(H);
    u -= solver.solve(gradient);
    solution.covariance = solver.solve(Information::Identity());
  }
  u(kYaw) = geometry::wrap_angle_rad(u(kYaw));
  solution.turn_sd_rad = scatter.turn_rad;
  return solution;
}

/// Whether the scans turn against the reference: they do in most of the turns that both see.
bool turns_against(const std::vector<MotionPair>& pairs) {
  double with = 0.0, against = 0.0;
  for (const MotionPair& pair : pairs) {
    const double product = pair.laser.z() * pair.reference.z();
    (product > 0.0 ? with : against) += std::abs(product);
  }
  // derived: noise turns both ways alike; three quarters of all turning is no noise.
  return against > 3.0 * with;
}

}  // namespace

std::optional<MountEstimate> estimate_mount(const std::vector<MotionPair>& pairs) {
  if (pairs.size() < kMotionsMin) return std::nullopt;
  std::vector<MotionPair> seen = pairs;
  MountEstimate estimate;
  estimate.is_mirrored = turns_against(pairs);
  if (estimate.is_mirrored) {
    for (MotionPair& pair : seen) pair.laser = mirror_image(pair.laser);
  }
  const Solution solution = solve(seen);
  if (!solution.u.allFinite() || !solution.covariance.allFinite()) return std::nullopt;
  const auto figure = [&solution](Unknown k) {
    return Estimate{solution.u(k), std::sqrt(std::max(0.0, solution.covariance(k, k)))};
  };
  estimate.mount_x_m = figure(kX);
  estimate.mount_y_m = figure(kY);
  estimate.mount_yaw_rad = figure(kYaw);
  estimate.way_scale = figure(kWay);
  estimate.turn_scale = figure(kTurn);
  estimate.reference_lag_s = figure(kLag);
  estimate.num_pairs = static_cast<int>(pairs.size());
  return estimate;
}

}  // namespace orchard::pose
