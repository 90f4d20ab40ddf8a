// SPDX-License-Identifier: BSD-3-Clause
#include "pose/prior_map/vague_pose.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"
#include "pose/motion.hpp"

namespace orchard::pose {
namespace {

// derived: the grid reaches three standard deviations; its step is one, or what is fine for two
// landmarks' errors [m]; and a bound on its cost.
constexpr double kGridSigmas = 3.0;
constexpr double kGridStep_m = 2.0 * PriorMapConfig::kLandmarkSd_m;
constexpr int kGridStepsMax = 40;

// derived: beyond it a landmark adds nothing to a trunk; fractions of the trunks that are in the
// map, alike likely; the radius in which trunks are counted for the density of clutter [m], that of
// a plant with its shoots.
constexpr double kReachSigmas = 3.5;
constexpr std::array<double, 5> kOfMap{0.1, 0.3, 0.5, 0.7, 0.9};
constexpr double kClutter_m = 1.0;

}  // namespace

VaguePose::VaguePose(const PriorMap& map) : map_(map) {
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(map.size()); ++i) {
    sd_max_m_ = std::max(sd_max_m_, map[i].sd_m);
  }
}

void VaguePose::start(const Eigen::Vector3d& T_map_base, const Eigen::Matrix3d& covariance) {
  T_map_base_ = T_map_base;
  P_ = covariance;
}

void VaguePose::move(const Eigen::Vector3d& T_base_next, const Eigen::Matrix3d& covariance) {
  P_ = compose_covariance(T_map_base_, P_, T_base_next, covariance);
  T_map_base_ = geometry::compose(T_map_base_, T_base_next);
  T_map_base_.z() = geometry::wrap_angle_rad(T_map_base_.z());
}

std::vector<VaguePose::Target> VaguePose::targets_of(
    const std::vector<LocalTrunkMap::Trunk>& trunks) {
  // derived: the disc's area.
  constexpr double kAround_m2 = geometry::kPi * kClutter_m * kClutter_m;
  std::vector<Target> targets;
  for (const LocalTrunkMap::Trunk& trunk : trunks) {
    const auto num_around = std::count_if(trunks.begin(), trunks.end(), [&](const auto& other) {
      return (other.p_local - trunk.p_local).norm() < kClutter_m;
    });
    targets.push_back({trunk.p_local,
                       geometry::square(PriorMapConfig::kLandmarkSd_m) +
                           geometry::square(trunk.sd_m) + 0.5 * trunk.covariance.trace(),
                       static_cast<double>(num_around) / kAround_m2});
  }
  return targets;
}

/// The axes of the covariance, by its Cholesky factor; a rotation counts as it moves a trunk at
/// reach_m.
std::array<VaguePose::Axis, 3> VaguePose::axes(double reach_m) const {
  const Eigen::Matrix3d L = P_.llt().matrixL();
  std::array<Axis, 3> axes;
  for (int i = 0; i < 3; ++i) {
    Eigen::Vector3d sigma_m = L.col(i);
    sigma_m.z() *= reach_m;
    const double num = std::ceil(kGridSigmas * sigma_m.norm() / kGridStep_m);
    Axis& axis = axes[static_cast<std::size_t>(i)];
    axis.num = static_cast<int>(std::clamp(num, kGridSigmas, 1.0 * kGridStepsMax));
    axis.step_sigmas = kGridSigmas / axis.num;
    axis.step = axis.step_sigmas * L.col(i);
  }
  return axes;
}

/// Density of landmarks seen again at a point of the map [1/m2].
double VaguePose::density_at(const Eigen::Vector2d& p_map, double variance_m2) const {
  double density = 0.0;
  const double reach_m = kReachSigmas * std::sqrt(variance_m2 + sd_max_m_ * sd_max_m_);
  map_.near(p_map, reach_m, [&](std::int32_t i) {
    const double both_m2 = variance_m2 + map_[i].sd_m * map_[i].sd_m;
    density += std::exp(-0.5 * (map_[i].p_map - p_map).squaredNorm() / both_m2) /
               (2.0 * geometry::kPi * both_m2);
  });
  return density;
}

double VaguePose::log_likelihood(const std::vector<Target>& targets,
                                 const Eigen::Vector3d& T_map_base) const {
  const Eigen::Matrix2d R = geometry::rotation(T_map_base.z());
  std::array<double, kOfMap.size()> likelihood;
  likelihood.fill(1.0 / kOfMap.size());
  for (const Target& target : targets) {
    const Eigen::Vector2d p_map = T_map_base.head<2>() + R * target.p_base;
    const double again = density_at(p_map, target.variance_m2) / target.clutter_per_m2;
    for (std::size_t i = 0; i < kOfMap.size(); ++i)
      likelihood[i] *= 1.0 + kOfMap[i] * (again - 1.0);
  }
  double sum = 0.0;
  for (const double value : likelihood) sum += value;
  return std::log(sum);
}

void VaguePose::correct(const std::vector<LocalTrunkMap::Trunk>& around, double share) {
  const std::vector<Target> targets = targets_of(around);
  double reach_m = 1.0;
  for (const Target& target : targets) reach_m = std::max(reach_m, 0.5 * target.p_base.norm());
  struct Weighted {
    Eigen::Vector3d offset;
    double log_weight;
  };
  std::vector<Weighted> poses;
  const std::array<Axis, 3> grid = axes(reach_m);
  double most = -std::numeric_limits<double>::max();
  double prior_sum = 0.0, prior_d2 = 0.0;
  for (int i = -grid[0].num; i <= grid[0].num; ++i) {
    for (int j = -grid[1].num; j <= grid[1].num; ++j) {
      for (int k = -grid[2].num; k <= grid[2].num; ++k) {
        const double d2 = geometry::square(i * grid[0].step_sigmas) +
                          geometry::square(j * grid[1].step_sigmas) +
                          geometry::square(k * grid[2].step_sigmas);
        if (d2 > kGridSigmas * kGridSigmas) continue;
        const Eigen::Vector3d offset = i * grid[0].step + j * grid[1].step + k * grid[2].step;
        const double log_weight = share * log_likelihood(targets, T_map_base_ + offset) - 0.5 * d2;
        poses.push_back({offset, log_weight});
        most = std::max(most, log_weight);
        prior_sum += std::exp(-0.5 * d2);
        prior_d2 += std::exp(-0.5 * d2) * d2;
      }
    }
  }
  double sum = 0.0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  for (const Weighted& pose : poses) {
    const double weight = std::exp(pose.log_weight - most);
    sum += weight;
    mean += weight * pose.offset;
    moment += weight * pose.offset * pose.offset.transpose();
  }
  mean /= sum;
  // What the grid cuts off the Gaussian is no information.
  const double cut_off = prior_d2 / (3.0 * prior_sum);
  P_ = (moment / sum - mean * mean.transpose()) / cut_off;
  T_map_base_ += mean;
  T_map_base_.z() = geometry::wrap_angle_rad(T_map_base_.z());
}

}  // namespace orchard::pose
