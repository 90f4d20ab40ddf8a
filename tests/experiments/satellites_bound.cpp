// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/satellites_bound.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"
#include "simulation/simulator.hpp"

namespace orchard {
namespace {

/// State: pose; scale and turn scale of the run; those of the ground; bias of the run and the
/// wandering one; slow error of the receiver.
enum Index { kX, kY, kYaw, kScale, kTurn, kSlip, kTurnSlip, kBias, kWander, kEast, kNorth, kSize };
using Vector = Eigen::Matrix<double, kSize, 1>;
using Matrix = Eigen::Matrix<double, kSize, kSize>;

constexpr double kNode_s = 0.2;  ///< between stored states
constexpr int kRounds = 3;       ///< of linearisation, the first about the truth
constexpr double kAnywhere_m = 1e3;

/// Correlation length of the simulated ground in patches: the integral of the autocorrelation of
/// its bilinear noise.
constexpr double kGround_patches = 0.67;

double square(double a) { return a * a; }

/// Stationary variances and correlations of a step.
struct Model {
  Vector variance = Vector::Zero();  ///< initial, and of a decayed state
  double slip_m, bias_s, receiver_s, load, load_every_s, speed_sd_mps, yaw_rate_sd_radps, fix_sd_m;

  explicit Model(const io::Config& config) {
    const auto& motion = config.simulation.motion;
    const auto& wheels = config.simulation.wheels;
    const auto& sky = config.simulation.gnss.sky;
    variance(kX) = variance(kY) = square(kAnywhere_m);
    variance(kYaw) = square(geometry::kPi);
    variance(kScale) = square(motion.speed_scale_sd) + square(wheels.load_sd);
    variance(kTurn) = square(wheels.yaw_rate_scale_sd);
    variance(kSlip) = square(wheels.surface_slip_sd);
    variance(kTurnSlip) = square(wheels.surface_turn_slip_sd);
    variance(kBias) = square(motion.yaw_rate_bias_sd_radps);
    variance(kWander) = square(wheels.bias_wander_sd_radps);
    variance(kEast) = variance(kNorth) = square(sky.wander_sd_m);
    slip_m = kGround_patches * wheels.surface_m;
    bias_s = wheels.bias_wander_s;
    receiver_s = sky.wander_time_s;
    load = 2.0 * square(wheels.load_sd);
    load_every_s = wheels.load_every_s;
    speed_sd_mps = motion.speed_sd_mps;
    yaw_rate_sd_radps = motion.yaw_rate_sd_radps;
    fix_sd_m = motion.gnss_sd_m;
  }
};

struct Node {
  double time_s = 0.0;
  Matrix F = Matrix::Identity();  ///< from the node before
  Matrix before_P, P, smooth_P;
  Vector before, now, smooth;  ///< relative to the linearisation
  Vector about;                ///< the linearisation
};

Vector truth_at(const simulation::DrivePath& truth, double time_s) {
  const simulation::Pose2 pose = truth.pose_at(time_s);
  Vector state = Vector::Zero();
  state.head<3>() << pose.x_m, pose.y_m, pose.yaw_rad;
  return state;
}

/// Moves a linearisation point by one reading; returns its derivative and adds its noise to Q.
Matrix move(const pose::Odometry& reading, double time_s, double dt_s, const Model& model,
            Vector& state, Matrix& Q) {
  const double wheels_m = reading.speed_mps * dt_s, wheels_rad = reading.yaw_rate_radps * dt_s;
  const double scale = 1.0 + state(kScale) + state(kSlip);
  const double turning = 1.0 + state(kTurn) + state(kTurnSlip);
  const double rad = wheels_rad / turning - (state(kBias) + state(kWander)) * dt_s;
  const double heading_rad = state(kYaw) + 0.5 * rad;
  const Eigen::Vector2d along(std::cos(heading_rad), std::sin(heading_rad));
  const Eigen::Vector2d across(-along.y(), along.x());
  const double length_m = wheels_m / scale;
  Vector length_by = Vector::Zero(), turn_by = Vector::Zero();
  length_by(kScale) = length_by(kSlip) = -length_m / scale;
  turn_by(kTurn) = turn_by(kTurnSlip) = -wheels_rad / square(turning);
  turn_by(kBias) = turn_by(kWander) = -dt_s;
  Matrix F = Matrix::Identity();
  Vector heading_by = 0.5 * turn_by;
  heading_by(kYaw) += 1.0;
  F.topRows<2>() += along * length_by.transpose() + length_m * across * heading_by.transpose();
  F.row(kYaw) += turn_by.transpose();
  Vector kept = Vector::Ones();
  kept(kSlip) = kept(kTurnSlip) = std::exp(-std::abs(length_m) / model.slip_m);
  kept(kWander) = std::exp(-dt_s / model.bias_s);
  kept(kEast) = kept(kNorth) = std::exp(-dt_s / model.receiver_s);
  F = kept.asDiagonal() * F;
  state.head<2>() += length_m * along;
  state(kYaw) += rad;
  state = kept.cwiseProduct(state).eval();

  Q = F * Q * F.transpose();
  const double length_sd_m = model.speed_sd_mps * dt_s, turn_sd = model.yaw_rate_sd_radps * dt_s;
  Q.topLeftCorner<2, 2>() += square(length_sd_m) * along * along.transpose();
  Q(kYaw, kYaw) += square(turn_sd);
  Q.diagonal() += ((1.0 - kept.array().square()) * model.variance.array()).matrix();
  if (std::floor(time_s / model.load_every_s) != std::floor((time_s - dt_s) / model.load_every_s)) {
    Q(kScale, kScale) += model.load;
  }
  return F;
}

void correct(const Eigen::Vector2d& off_m, const Eigen::Vector2d& arm_m, double variance,
             Node& node) {
  Eigen::Matrix<double, 2, kSize> H = Eigen::Matrix<double, 2, kSize>::Zero();
  H(0, kX) = H(1, kY) = H(0, kEast) = H(1, kNorth) = 1.0;
  H.col(kYaw) = Eigen::Vector2d(-arm_m.y(), arm_m.x());
  const Eigen::Matrix2d S = H * node.P * H.transpose() + variance * Eigen::Matrix2d::Identity();
  const Eigen::Matrix<double, kSize, 2> K = node.P * H.transpose() * S.inverse();
  node.now += K * (off_m - H * node.now);
  node.P -= K * S * K.transpose();
  node.P = 0.5 * (node.P + node.P.transpose()).eval();
}

Vector about_at(const std::vector<Node>& past, const simulation::DrivePath& truth, double time_s) {
  Vector state = truth_at(truth, time_s);
  if (past.empty()) return state;
  const auto after =
      std::upper_bound(past.begin(), past.end(), time_s,
                       [](double time, const Node& node) { return time < node.time_s; });
  const Node& a = after == past.begin() ? *after : *std::prev(after);
  const Node& b = after == past.end() ? a : *after;
  const double part =
      b.time_s > a.time_s ? std::clamp((time_s - a.time_s) / (b.time_s - a.time_s), 0.0, 1.0) : 0.0;
  const auto off = [&](const Node& n) -> Vector {
    return n.about + n.smooth - truth_at(truth, n.time_s);
  };
  Vector first = off(a), second = off(b);
  first(kYaw) = geometry::wrap_angle_rad(first(kYaw));
  second(kYaw) = geometry::wrap_angle_rad(second(kYaw));
  return state + (1.0 - part) * first + part * second;
}

std::vector<Node> smoothed(const Model& model, const io::Config& config,
                           const simulation::DrivePath& truth, const std::vector<Node>& past,
                           const std::vector<pose::Odometry>& odometry,
                           const std::vector<PlacedFix>& fixes) {
  const Eigen::Vector2d antenna(config.simulation.gnss.antenna_m[0],
                                config.simulation.gnss.antenna_m[1]);
  std::vector<Node> nodes;
  auto fix = fixes.begin();
  Matrix F = Matrix::Identity(), Q = Matrix::Zero();
  double before_s = 0.0;
  Vector shift = Vector::Zero();  // of the linearisation since the node before
  const auto add_node = [&](double time_s) {
    Node node;
    node.time_s = time_s;
    node.about = about_at(past, truth, time_s);
    node.F = F;
    if (nodes.empty()) {
      node.before = Vector::Zero();
      // The prior is about zero sensor errors and anywhere.
      node.before.tail<kSize - 3>() = -node.about.tail<kSize - 3>();
      node.before_P = model.variance.asDiagonal();
    } else {
      node.before = F * nodes.back().now + shift;
      node.before_P = F * nodes.back().P * F.transpose() + Q;
    }
    node.now = node.before;
    node.P = node.before_P;
    for (; fix != fixes.end() && fix->time_s <= time_s; ++fix) {
      const Eigen::Vector2d arm = geometry::rotation(node.about(kYaw)) * antenna;
      // The receiver's error moves little within a step; the robot's way since the fix does not.
      const Vector then = about_at(past, truth, fix->time_s);
      const Eigen::Vector2d off = fix->p_map_m - then.head<2>() - arm - then.tail<2>();
      correct(off, arm, square(model.fix_sd_m), node);
    }
    nodes.push_back(node);
    F = Matrix::Identity();
    Q = Matrix::Zero();
    shift = Vector::Zero();
  };
  for (const pose::Odometry& reading : odometry) {
    const double time_s = 1e-6 * static_cast<double>(reading.utime - simulation::kEpochUtime);
    if (nodes.empty()) {
      add_node(time_s);
    } else if (time_s > before_s) {
      Vector state = about_at(past, truth, before_s);
      const Matrix step = move(reading, time_s, time_s - before_s, model, state, Q);
      F = step * F;
      Vector moved = state - about_at(past, truth, time_s);
      moved(kYaw) = geometry::wrap_angle_rad(moved(kYaw));
      shift = step * shift + moved;
      if (time_s - nodes.back().time_s >= kNode_s - 1e-9) add_node(time_s);
    }
    before_s = time_s;
  }
  for (std::size_t i = nodes.size(); i-- > 0;) {
    Node& node = nodes[i];
    node.smooth = node.now;
    node.smooth_P = node.P;
    if (i + 1 == nodes.size()) continue;
    const Node& next = nodes[i + 1];
    const Matrix G = next.before_P.ldlt().solve(Matrix(next.F * node.P)).transpose();
    node.smooth += G * (next.smooth - next.before);
    node.smooth_P += G * (next.smooth_P - next.before_P) * G.transpose();
  }
  return nodes;
}

}  // namespace

std::vector<BoundPose> bound_of(const io::Config& config, const simulation::DrivePath& truth,
                                const std::vector<pose::Odometry>& odometry,
                                const std::vector<PlacedFix>& fixes) {
  const Model model(config);
  std::vector<Node> nodes;
  for (int round = 0; round < kRounds; ++round) {
    nodes = smoothed(model, config, truth, nodes, odometry, fixes);
  }
  std::vector<BoundPose> path;
  for (const Node& node : nodes) {
    BoundPose pose;
    pose.time_s = node.time_s;
    pose.told_m = (node.about + node.now).head<2>();
    pose.p_map_m = (node.about + node.smooth).head<2>();
    pose.covariance = node.smooth_P.topLeftCorner<2, 2>();
    path.push_back(pose);
  }
  return path;
}

Eigen::Vector3d map_bound_of(const io::Config& config, const simulation::DrivePath& truth,
                             const std::vector<PlacedFix>& fixes) {
  // A Kalman filter over the transform (constant) and the receiver's slow error.
  using State = Eigen::Matrix<double, 5, 1>;
  using Covariance = Eigen::Matrix<double, 5, 5>;
  const Model model(config);
  const double slow = model.variance(kEast);
  State state = State::Zero();
  Covariance P = Covariance::Zero();
  P.diagonal() << square(kAnywhere_m), square(kAnywhere_m), square(geometry::kPi), slow, slow;
  double before_s = 0.0;
  for (const PlacedFix& fix : fixes) {
    const double kept = std::exp(-(fix.time_s - before_s) / model.receiver_s);
    before_s = fix.time_s;
    state.tail<2>() *= kept;
    P.rightCols<2>() *= kept;
    P.bottomRows<2>() *= kept;
    P.diagonal().tail<2>().array() += (1.0 - square(kept)) * slow;
    const simulation::Pose2 pose = truth.pose_at(fix.time_s);
    const auto& arm_m = config.simulation.gnss.antenna_m;
    const simulation::Pose2 at = compose(pose, {arm_m[0], arm_m[1], 0.0});
    const Eigen::Vector2d antenna(at.x_m, at.y_m);
    Eigen::Matrix<double, 2, 5> H = Eigen::Matrix<double, 2, 5>::Zero();
    H(0, 0) = H(1, 1) = H(0, 3) = H(1, 4) = 1.0;
    H.col(2) = Eigen::Vector2d(-antenna.y(), antenna.x());
    const Eigen::Matrix2d S =
        H * P * H.transpose() + square(model.fix_sd_m) * Eigen::Matrix2d::Identity();
    const Eigen::Matrix<double, 5, 2> K = P * H.transpose() * S.inverse();
    state += K * (fix.p_map_m - antenna - H * state);
    P -= K * S * K.transpose();
    P = 0.5 * (P + P.transpose()).eval();
  }
  return state.head<3>();
}

}  // namespace orchard
