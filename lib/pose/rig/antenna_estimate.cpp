// SPDX-License-Identifier: BSD-3-Clause
#include "pose/rig/antenna_estimate.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"

namespace orchard::pose {
namespace {

using geometry::rotation;
using geometry::square;

/// derived: four times the five unknowns of a stretch.
constexpr std::size_t kFixesMin = 20;
/// derived: from a start by the path's own shape the error halves at least in each round.
constexpr int kAntennaRounds = 15;
/// derived: Huber's weight, at 95 % of the efficiency of least squares.
constexpr double kHuber_sigma = 1.345;
/// physical: an antenna sits on its robot.
constexpr double kAntennaSd_m = 5.0;
/// physical: no receiver is better.
constexpr double kFixFloor_m = 0.005;

/// Heading of a stretch's frame in ENU by the directions from its middle.
double start_yaw_rad(const std::vector<AntennaView>& views, const Eigen::Vector2d& middle_path,
                     const Eigen::Vector2d& middle_enu) {
  double along = 0.0, across = 0.0;
  for (const AntennaView& view : views) {
    const Eigen::Vector2d a = view.T_path_laser.head<2>() - middle_path;
    const Eigen::Vector2d b = view.p_enu_m - middle_enu;
    along += a.dot(b);
    across += a.x() * b.y() - a.y() * b.x();
  }
  return std::atan2(across, along);
}

Eigen::Vector3d first_frame(const std::vector<AntennaView>& views) {
  Eigen::Vector2d path = Eigen::Vector2d::Zero(), enu = path;
  for (const AntennaView& view : views) {
    path += view.T_path_laser.head<2>();
    enu += view.p_enu_m;
  }
  path /= static_cast<double>(views.size());
  enu /= static_cast<double>(views.size());
  const double yaw_rad = start_yaw_rad(views, path, enu);
  Eigen::Vector3d T_enu_path;
  T_enu_path << enu - rotation(yaw_rad) * path, yaw_rad;
  return T_enu_path;
}

/// Where a view's antenna is in ENU, seen from the stretch's frame.
Eigen::Vector2d seen_enu(const Eigen::Vector3d& T_enu_path, const AntennaView& view,
                         const Eigen::Vector2d& p_laser) {
  return geometry::transform(T_enu_path, geometry::transform(view.T_path_laser, p_laser));
}

class Registration {
 public:
  explicit Registration(const std::vector<std::vector<AntennaView>>& stretches)
      : stretches_(stretches) {
    for (const auto& views : stretches_) frames_.push_back(first_frame(views));
  }

  AntennaEstimate solved() {
    for (int round = 0; round < kAntennaRounds; ++round) step();
    // Errors of neighbouring fixes are alike: as many count as if each repeated its predecessor by
    // this correlation.
    const double alike = std::clamp(correlation(), 0.0, 0.98);
    AntennaEstimate estimate;
    estimate.p_laser_m = p_laser_m_;
    estimate.covariance = (1.0 + alike) / (1.0 - alike) * covariance_;
    for (const auto& views : stretches_) estimate.num_fixes += static_cast<int>(views.size());
    return estimate;
  }

 private:
  double scatter_m() const {
    std::vector<double> errors_m;
    for_each([&errors_m](std::size_t, const AntennaView&, const Eigen::Vector2d& r) {
      errors_m.push_back(r.x());
      errors_m.push_back(r.y());
    });
    return std::max(kFixFloor_m, geometry::robust_sd(std::move(errors_m)));
  }

  double correlation() const {
    double product = 0.0, squares = 0.0;
    std::size_t last_stretch = stretches_.size();
    Eigen::Vector2d last = Eigen::Vector2d::Zero();
    for_each([&](std::size_t stretch, const AntennaView&, const Eigen::Vector2d& r) {
      if (stretch == last_stretch) product += r.dot(last);
      squares += r.squaredNorm();
      last_stretch = stretch;
      last = r;
    });
    return squares > 0.0 ? product / squares : 0.0;
  }

  template <class Visitor>
  void for_each(const Visitor& visit) const {
    for (std::size_t k = 0; k < stretches_.size(); ++k) {
      for (const AntennaView& view : stretches_[k]) {
        visit(k, view, view.p_enu_m - seen_enu(frames_[k], view, p_laser_m_));
      }
    }
  }

  /// One step of Gauss and Newton for all frames and the antenna.
  void step() {
    const double sd_m = scatter_m();
    const auto num = static_cast<Eigen::Index>(3 * stretches_.size() + 2);
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(num, num);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(num);
    H.bottomRightCorner<2, 2>().diagonal().setConstant(1.0 / square(kAntennaSd_m));
    g.tail<2>() = -p_laser_m_ / square(kAntennaSd_m);
    for_each([&](std::size_t stretch, const AntennaView& view, const Eigen::Vector2d& r) {
      const auto at = static_cast<Eigen::Index>(3 * stretch);
      const Eigen::Vector3d& T = frames_[stretch];
      const double sigma = r.norm() / (std::sqrt(2.0) * sd_m);
      const double weight = (sigma > kHuber_sigma ? kHuber_sigma / sigma : 1.0) / square(sd_m);
      Eigen::Matrix<double, 2, 5> J;
      J.leftCols<3>() = geometry::point_jacobian(seen_enu(T, view, p_laser_m_) - T.head<2>());
      J.rightCols<2>() = rotation(T.z() + view.T_path_laser.z());
      const Eigen::Matrix<double, 5, 5> h = weight * J.transpose() * J;
      const Eigen::Matrix<double, 5, 1> b = weight * J.transpose() * r;
      H.block<3, 3>(at, at) += h.topLeftCorner<3, 3>();
      H.block<3, 2>(at, num - 2) += h.topRightCorner<3, 2>();
      H.block<2, 3>(num - 2, at) += h.bottomLeftCorner<2, 3>();
      H.bottomRightCorner<2, 2>() += h.bottomRightCorner<2, 2>();
      g.segment<3>(at) += b.head<3>();
      g.tail<2>() += b.tail<2>();
    });
    const Eigen::LDLT<Eigen::MatrixXd> solver(H);
    const Eigen::VectorXd change = solver.solve(g);
    for (std::size_t k = 0; k < frames_.size(); ++k) {
      frames_[k] += change.segment<3>(static_cast<Eigen::Index>(3 * k));
    }
    p_laser_m_ += change.tail<2>();
    Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(num, 2);
    unit.bottomRows<2>().setIdentity();
    covariance_ = solver.solve(unit).bottomRows<2>();
  }

  const std::vector<std::vector<AntennaView>>& stretches_;
  std::vector<Eigen::Vector3d> frames_;  ///< T_enu_path of each stretch
  Eigen::Vector2d p_laser_m_ = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance_ = Eigen::Matrix2d::Identity();
};

}  // namespace

std::optional<AntennaEstimate> estimate_antenna(
    const std::vector<std::vector<AntennaView>>& stretches) {
  std::size_t num_fixes = 0;
  for (const auto& views : stretches) num_fixes += views.size();
  if (num_fixes < kFixesMin) return std::nullopt;
  const AntennaEstimate estimate = Registration(stretches).solved();
  if (!estimate.p_laser_m.allFinite() || !estimate.covariance.allFinite()) return std::nullopt;
  return estimate;
}

}  // namespace orchard::pose
