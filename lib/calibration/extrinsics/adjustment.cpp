// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/extrinsics/adjustment.hpp"

#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <fmt/core.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "calibration/tuning.hpp"
#include "geometry/angles.hpp"

namespace orchard::calibration {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

// derived: 6 degrees from grazing; numbers of unknowns.
constexpr double kMinIncidence =
    0.1;                       ///< cosine; lower limit that keeps a grazing beam's noise above 0
constexpr int kMountSize = 6;  ///< delta, rotation
constexpr int kViewSize = 7;   ///< rotation and shift of the board, range error

Eigen::Vector3d bearing_vector(double bearing_rad) {
  return {std::cos(bearing_rad), std::sin(bearing_rad), 0.0};
}

/// Range at which a beam intersects the line fitted to all beams.
double smooth_range_m(const BoardLine& line, std::size_t beam) {
  const Eigen::Vector2d across(-line.direction.y(), line.direction.x());
  const double along = across.dot(bearing_vector(line.bearings_rad[beam]).head<2>());
  if (std::abs(along) < 0.02) return line.ranges_m[beam];  // grazing
  return across.dot(line.middle_m) / along;
}

template <class T>
Eigen::Matrix<T, 3, 1> turned(const T* turn, const Eigen::Matrix<T, 3, 1>& p) {
  Eigen::Matrix<T, 3, 1> result;
  ceres::AngleAxisRotatePoint(turn, p.data(), result.data());
  return result;
}

/// Linearization point of a view's residuals; the unknowns are small changes of it.
struct Geometry {
  RigidExtrinsics mount;
  Eigen::Matrix3d R_camera_board;
  Eigen::Vector3d t_camera_board_m;
};

/// Applies (rotation, shift) of `view` to the board; gives the normal and origin of its plane.
template <class T>
void changed_board(const Geometry& g, const T* view, Eigen::Matrix<T, 3, 1>& normal,
                   Eigen::Matrix<T, 3, 1>& origin) {
  const Eigen::Matrix<T, 3, 1> z = g.R_camera_board.col(2).cast<T>();
  normal = turned(view, z);
  for (int i = 0; i < 3; ++i) origin[i] = T(g.t_camera_board_m[i]) + view[3 + i];
}

/// Residual: a beam ends on the board.
struct BeamOnBoard {
  Geometry g;
  double range_m;
  double smooth_range_m;  ///< without the beam's noise, whose scaling would bias the scale to small
                          ///< values
  Eigen::Vector3d bearing;
  double sd_m;

  template <class T>
  bool operator()(const T* mount, const T* view, const T* scale, T* residual) const {
    Eigen::Matrix<T, 3, 1> normal, origin;
    changed_board(g, view, normal, origin);
    const T range = T(range_m) - T(smooth_range_m) * (view[6] + scale[0]);
    const Eigen::Matrix<T, 3, 1> turned_bearing =
        (g.mount.R_camera_laser * bearing).cast<T>() * range;
    Eigen::Matrix<T, 3, 1> p = turned(mount + 3, turned_bearing);
    for (int i = 0; i < 3; ++i) p[i] += T(g.mount.delta_m[i]) + mount[i];
    residual[0] = normal.dot(p - origin) / T(sd_m);
    return true;
  }
};

/// Residual: the ray at a line's end meets the board's plane on one of its edges.
struct EndOnEdge {
  Geometry g;
  Eigen::Vector3d bearing;
  int axis;  ///< 0: an edge of constant x, 1: of constant y
  double edge_m;
  double sd_m;

  template <class T>
  bool operator()(const T* mount, const T* view, T* residual) const {
    Eigen::Matrix<T, 3, 1> normal, origin;
    changed_board(g, view, normal, origin);
    const Eigen::Matrix<T, 3, 1> start_ray = (g.mount.R_camera_laser * bearing).cast<T>();
    const Eigen::Matrix<T, 3, 1> ray = turned(mount + 3, start_ray);
    Eigen::Matrix<T, 3, 1> from_board;
    for (int i = 0; i < 3; ++i) from_board[i] = T(g.mount.delta_m[i]) + mount[i] - origin[i];
    const T along = -normal.dot(from_board) / normal.dot(ray);
    const Eigen::Matrix<T, 3, 1> in_camera = from_board + along * ray;
    const Eigen::Matrix<T, 3, 1> axis_start = g.R_camera_board.col(axis).cast<T>();
    residual[0] = (turned(view, axis_start).dot(in_camera) - T(edge_m)) / T(sd_m);
    return true;
  }
};

/// Prior: the board's pose from the image, and zero range error.
struct ViewPrior {
  Eigen::Matrix<double, kViewSize, kViewSize> whitening;

  template <class T>
  bool operator()(const T* view, T* residual) const {
    Eigen::Map<const Eigen::Matrix<T, kViewSize, 1>> x(view);
    Eigen::Map<Eigen::Matrix<T, kViewSize, 1>> r(residual);
    r = whitening.cast<T>() * x;
    return true;
  }
};

struct ScalePrior {
  double sd;
  template <class T>
  bool operator()(const T* scale, T* residual) const {
    residual[0] = scale[0] / T(sd);
    return true;
  }
};

enum class Group { kBeam, kEdge, kView, kScale };

class Adjustment {
 public:
  Adjustment(const std::vector<AdjustmentView>& views, const RangeNoise& noise,
             const BoardOutline* outline)
      : views_(views), noise_(noise), outline_(outline) {}

  std::optional<ExtrinsicsAdjustment> run(const RigidExtrinsics& start) {
    out_.mount = start;
    // derived: budget of the variance components.
    constexpr int kRounds = 8;
    for (int round = 0; round < kRounds; ++round) {
      const double beam_before = out_.beam_factor, scan_before = out_.scan_factor;
      if (!solve_once()) return std::nullopt;
      const bool settled = std::abs(out_.beam_factor - beam_before) < 0.01 * beam_before &&
                           std::abs(out_.scan_factor - scan_before) < 0.01 * scan_before;
      if (round >= 2 && settled) break;
    }
    measure_views();
    return out_;
  }

 private:
  /// Solves around the present mount and updates it.
  bool solve_once() {
    const std::size_t num_views = views_.size();
    std::array<double, kMountSize> mount{};
    std::vector<std::array<double, kViewSize>> unknowns(num_views);
    for (auto& u : unknowns) u.fill(0.0);
    double scale = 0.0;

    ceres::Problem problem;
    std::vector<Group> groups;  // of residual blocks, in order
    problem.AddParameterBlock(mount.data(), kMountSize);
    problem.AddParameterBlock(&scale, 1);
    for (std::size_t i = 0; i < num_views; ++i) {
      problem.AddParameterBlock(unknowns[i].data(), kViewSize);
    }
    for (std::size_t i = 0; i < num_views; ++i) {
      add_view(problem, groups, views_[i], mount.data(), unknowns[i].data(), &scale);
    }
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<ScalePrior, 1, 1>(
                                 new ScalePrior{std::max(1e-6, noise_.scale_sd_fraction)}),
                             nullptr, &scale);
    groups.push_back(Group::kScale);

    ceres::Solver::Options options;
    options.num_threads = 1;
    options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    options.max_num_iterations = 50;
    options.function_tolerance = 1e-12;
    options.parameter_tolerance = 1e-10;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    if (!summary.IsSolutionUsable()) return false;
    if (!evaluate(problem, groups)) return false;
    out_.scale = scale;

    const Eigen::Map<const Eigen::Vector3d> shift(mount.data()), turn(mount.data() + 3);
    out_.mount.delta_m += shift;
    out_.mount.R_camera_laser = rotation_of(turn) * out_.mount.R_camera_laser;
    return out_.mount.R_camera_laser.allFinite() && out_.mount.delta_m.allFinite();
  }

  void add_view(ceres::Problem& problem, std::vector<Group>& groups, const AdjustmentView& view,
                double* mount, double* unknowns, double* scale) const {
    const Geometry g{out_.mount, view.board.R_camera_board, view.board.t_camera_board_m};
    const Eigen::Vector3d normal = view.board.normal_camera();
    const double averaged = std::sqrt(static_cast<double>(std::max(1, view.num_scans)));
    for (std::size_t k = 0; k < view.line.ranges_m.size(); ++k) {
      const double range_m = view.line.ranges_m[k];
      const Eigen::Vector3d bearing = bearing_vector(view.line.bearings_rad[k]);
      const double incidence =
          std::max(kMinIncidence, std::abs(normal.dot(out_.mount.R_camera_laser * bearing)));
      const double sd_m = out_.beam_factor * incidence / averaged *
                          (noise_.beam_sd_m + noise_.beam_sd_fraction * range_m);
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<BeamOnBoard, 1, kMountSize, kViewSize, 1>(new BeamOnBoard{
              g, range_m, smooth_range_m(view.line, k), bearing, std::max(1e-5, sd_m)}),
          new ceres::HuberLoss(tuning::kHuber), mount, unknowns, scale);
      groups.push_back(Group::kBeam);
    }
    if (outline_) {
      add_edge(problem, groups, g, view.line.start, mount, unknowns);
      add_edge(problem, groups, g, view.line.end, mount, unknowns);
    }
    Eigen::Matrix<double, kViewSize, kViewSize> whitening;
    whitening.setZero();
    const Matrix6 root = view.board.covariance.llt().matrixL();
    whitening.topLeftCorner<6, 6>() =
        root.triangularView<Eigen::Lower>().solve(Matrix6::Identity());
    whitening(6, 6) = averaged / std::max(1e-6, out_.scan_factor * noise_.scan_sd_fraction);
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<ViewPrior, kViewSize, kViewSize>(new ViewPrior{whitening}),
        nullptr, unknowns);
    groups.push_back(Group::kView);
  }

  void add_edge(ceres::Problem& problem, std::vector<Group>& groups, const Geometry& g,
                const LineEnd& end, double* mount, double* unknowns) const {
    if (!end.seen) return;
    const auto on_board = [&](double bearing_rad) {
      const Eigen::Vector3d ray = g.mount.R_camera_laser * bearing_vector(bearing_rad);
      const Eigen::Vector3d from_board = g.mount.delta_m - g.t_camera_board_m;
      const Eigen::Vector3d normal = g.R_camera_board.col(2);
      const double along = -normal.dot(from_board) / normal.dot(ray);
      return Eigen::Vector3d(g.R_camera_board.transpose() * (from_board + along * ray));
    };
    const Eigen::Vector3d p = on_board(end.bearing_rad);
    const std::array<double, 4> edges{outline_->x_min_m, outline_->x_max_m, outline_->y_min_m,
                                      outline_->y_max_m};
    int nearest = 0;
    double off_m = 1e9;
    for (int k = 0; k < 4; ++k) {
      const double d = std::abs(p[k / 2] - edges[static_cast<std::size_t>(k)]);
      if (d < off_m) {
        off_m = d;
        nearest = k;
      }
    }
    if (off_m > tuning::kEdgeGate_m) return;
    const int axis = nearest / 2;
    // Uniform between the last beam on the board and the first beyond it.
    const double spread_m = std::abs(on_board(end.bearing_rad + end.half_gap_rad)[axis] -
                                     on_board(end.bearing_rad - end.half_gap_rad)[axis]);
    const double sd_m = std::max(5e-4, spread_m / std::sqrt(12.0));
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<EndOnEdge, 1, kMountSize, kViewSize>(
                                 new EndOnEdge{g, bearing_vector(end.bearing_rad), axis,
                                               edges[static_cast<std::size_t>(nearest)], sd_m}),
                             new ceres::HuberLoss(tuning::kHuber), mount, unknowns);
    groups.push_back(Group::kEdge);
  }

  /// Covariance, residuals and variance components at the solution.
  bool evaluate(ceres::Problem& problem, const std::vector<Group>& groups) {
    ceres::Problem::EvaluateOptions options;
    options.num_threads = 1;
    options.apply_loss_function = true;
    std::vector<double> weighted;
    ceres::CRSMatrix sparse;
    double cost = 0.0;
    if (!problem.Evaluate(options, &cost, &weighted, nullptr, &sparse)) return false;

    const int size = sparse.num_cols;
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(sparse.num_rows, size);
    for (int row = 0; row < sparse.num_rows; ++row) {
      for (int k = sparse.rows[static_cast<std::size_t>(row)];
           k < sparse.rows[static_cast<std::size_t>(row) + 1]; ++k) {
        J(row, sparse.cols[static_cast<std::size_t>(k)]) =
            sparse.values[static_cast<std::size_t>(k)];
      }
    }
    const Eigen::MatrixXd N = J.transpose() * J;
    // Scale to a unit diagonal for conditioning: the units are metres, radians and fractions.
    const Eigen::VectorXd s = N.diagonal().cwiseSqrt().cwiseMax(1e-12).cwiseInverse();
    Eigen::MatrixXd scaled = s.asDiagonal() * N * s.asDiagonal();
    scaled.diagonal().array() += 1e-13;
    const Eigen::LDLT<Eigen::MatrixXd> solver(scaled);
    if (solver.info() != Eigen::Success) return false;
    const Eigen::MatrixXd Q =
        s.asDiagonal() * solver.solve(Eigen::MatrixXd::Identity(size, size)) * s.asDiagonal();
    out_.covariance = Q.topLeftCorner<kMountSize, kMountSize>();
    out_.scale_sd = std::sqrt(std::max(0.0, Q(kMountSize, kMountSize)));
    if (!out_.covariance.allFinite()) return false;

    out_.views.assign(views_.size(), {});
    double beam_sum = 0.0, beam_redundancy = 0.0, scan_sum = 0.0, scan_redundancy = 0.0;
    out_.num_points = 0;
    std::size_t view = 0, row = 0;
    for (const Group group : groups) {
      const auto r = static_cast<Eigen::Index>(row);
      if (group == Group::kBeam) {
        beam_sum += weighted[row] * weighted[row];
        beam_redundancy += 1.0 - (J.row(r) * Q).dot(J.row(r));
        ++out_.num_points;
      } else if (group == Group::kView) {
        const auto scan_row = r + kViewSize - 1;
        scan_sum += weighted[row + kViewSize - 1] * weighted[row + kViewSize - 1];
        scan_redundancy += 1.0 - (J.row(scan_row) * Q).dot(J.row(scan_row));
        double squares = 0.0;
        for (std::size_t k = 0; k < kViewSize; ++k)
          squares += weighted[row + k] * weighted[row + k];
        out_.views[view++].disagreement = std::sqrt(squares);
      }
      row += group == Group::kView ? kViewSize : 1;
    }
    out_.scan_redundancy = scan_redundancy;
    if (beam_redundancy > 3.0) {
      out_.beam_factor =
          std::clamp(out_.beam_factor * std::sqrt(beam_sum / beam_redundancy), 0.02, 20.0);
    }
    if (scan_redundancy > 2.0) {
      out_.scan_factor =
          std::clamp(out_.scan_factor * std::sqrt(scan_sum / scan_redundancy), 0.05, 5.0);
    }
    return true;
  }

  /// Computes the distances of the scans' points from the boards of the images, for the report.
  void measure_views() {
    double sum = 0.0;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      const AdjustmentView& view = views_[i];
      const Eigen::Vector3d normal = view.board.normal_camera();
      double mean_m = 0.0, squares = 0.0;
      for (std::size_t k = 0; k < view.line.ranges_m.size(); ++k) {
        const Eigen::Vector3d p_laser =
            view.line.ranges_m[k] * bearing_vector(view.line.bearings_rad[k]);
        const double off_m = normal.dot(out_.mount.R_camera_laser * p_laser + out_.mount.delta_m) -
                             view.board.distance_m();
        mean_m += off_m;
        squares += off_m * off_m;
      }
      const double n = static_cast<double>(std::max<std::size_t>(1, view.line.ranges_m.size()));
      out_.views[i].mean_m = mean_m / n;
      out_.views[i].rms_m = std::sqrt(squares / n);
      sum += squares;
    }
    out_.rms_m = std::sqrt(sum / std::max(1, out_.num_points));
  }

  const std::vector<AdjustmentView>& views_;
  const RangeNoise& noise_;
  const BoardOutline* outline_;
  ExtrinsicsAdjustment out_;
};

}  // namespace

std::optional<ExtrinsicsAdjustment> adjust_extrinsics(const std::vector<AdjustmentView>& views,
                                                      const RigidExtrinsics& start,
                                                      const RangeNoise& noise,
                                                      const BoardOutline* outline) {
  if (views.empty()) return std::nullopt;
  return Adjustment(views, noise, outline).run(start);
}

namespace {

// derived: above the noise of a board's pose.
constexpr double kDeg = geometry::kPi / 180.0;
constexpr double kMinSpread = 0.05;  ///< min spread of the normals: 3 degrees
constexpr double kSameOrientation_rad = 6.0 * kDeg;
constexpr double kMoved_m = 0.05;

/// Variance of a normal's direction in one of the two directions perpendicular to it.
double normal_variance(const BoardPose& board) {
  return 0.5 * board.covariance.topLeftCorner<3, 3>().trace();
}

/// A direction by the nearest camera axis, or by its components.
std::string camera_direction(const Eigen::Vector3d& direction_camera) {
  static constexpr std::array<const char*, 3> kNames{
      "the camera's x axis (right)", "the camera's y axis (down)", "the camera's z axis (forward)"};
  const Eigen::Vector3d d = direction_camera.normalized();
  int axis = 0;
  d.cwiseAbs().maxCoeff(&axis);
  if (std::abs(d[axis]) > 0.85) return kNames[static_cast<std::size_t>(axis)];
  return fmt::format("the direction ({:.2f}, {:.2f}, {:.2f}) of the camera frame", d.x(), d.y(),
                     d.z());
}

}  // namespace

BoardMotion board_motion(const std::vector<BoardPose>& boards) {
  BoardMotion motion;
  if (boards.empty()) return motion;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  double noise = 0.0;
  std::vector<Eigen::Vector3d> orientations;
  motion.distance_min_m = motion.distance_max_m = boards.front().distance_m();
  for (const BoardPose& board : boards) {
    const Eigen::Vector3d n = board.normal_camera();
    scatter += n * n.transpose();
    noise += normal_variance(board);
    motion.distance_min_m = std::min(motion.distance_min_m, board.distance_m());
    motion.distance_max_m = std::max(motion.distance_max_m, board.distance_m());
    for (const BoardPose& other : boards) {
      const double cosine = std::clamp(n.dot(other.normal_camera()), -1.0, 1.0);
      motion.tilt_max_deg = std::max(motion.tilt_max_deg, std::acos(cosine) / kDeg);
      motion.moved_m =
          std::max(motion.moved_m, (board.t_camera_board_m - other.t_camera_board_m).norm());
    }
    const double near = kSameOrientation_rad + 2.0 * std::sqrt(normal_variance(board));
    const bool known =
        std::any_of(orientations.begin(), orientations.end(), [&](const Eigen::Vector3d& o) {
          return std::acos(std::clamp(o.dot(n), -1.0, 1.0)) < near;
        });
    if (!known) orientations.push_back(n);
  }
  const double count = static_cast<double>(boards.size());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter / count);
  const Eigen::Vector3d spread = (solver.eigenvalues().array() - noise / count).cwiseMax(0.0);
  motion.out_of_plane = std::sqrt(spread[0]);
  motion.out_of_line = std::sqrt(spread[1]);
  motion.axis_camera = solver.eigenvectors().col(0);
  motion.num_orientations = static_cast<int>(orientations.size());
  return motion;
}

std::string degenerate_motion(const BoardMotion& motion) {
  if (motion.out_of_plane >= kMinSpread) return {};
  if (motion.out_of_line < kMinSpread || motion.tilt_max_deg < tuning::kHardlyTilted_deg) {
    if (motion.moved_m < kMoved_m) {
      return "the board never moved, so most of the six unknowns are not determined; hold it in "
             "other places, tilted to all sides";
    }
    return fmt::format(
        "the board was always (nearly) parallel to itself, tilted by {:.1f} deg at most between "
        "two views, so translations along it are not determined; tilt it by 20 to 45 deg to the "
        "left and right, forward and back",
        motion.tilt_max_deg);
  }
  if (motion.num_orientations == 2) {
    return fmt::format("the board was held in two orientations only ({:.0f} deg apart): ",
                       motion.tilt_max_deg) +
           "the translation along " + camera_direction(motion.axis_camera) +
           ", the intersection of the two planes, is not determined; hold it in more orientations";
  }
  const Eigen::Vector3d across = motion.axis_camera.cwiseAbs();
  const char* advice = across.y() > 0.7   ? "tilt it forward and back, too"
                       : across.x() > 0.7 ? "turn it to the left and right, too"
                                          : "tilt it about a second axis, too";
  return "all boards were tilted about one axis only, " + camera_direction(motion.axis_camera) +
         ": the translation along that axis is not determined; " + advice;
}

std::string undetermined_direction(const Eigen::Matrix<double, 6, 6>& covariance,
                                   double shift_sd_max_m, double turn_sd_max_rad,
                                   const BoardMotion& motion) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> shift(
      Eigen::Matrix3d(covariance.topLeftCorner<3, 3>()));
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> turn(
      Eigen::Matrix3d(covariance.bottomRightCorner<3, 3>()));
  const double shift_sd_m = std::sqrt(std::max(0.0, shift.eigenvalues()[2]));
  const double turn_sd_rad = std::sqrt(std::max(0.0, turn.eigenvalues()[2]));
  std::string what;
  if (!(shift_sd_m <= shift_sd_max_m)) {
    what = "the translation along " + camera_direction(shift.eigenvectors().col(2)) +
           fmt::format(
               " is not determined (standard deviation {:.0f} mm, but at most {:.0f} is allowed)",
               1e3 * shift_sd_m, 1e3 * shift_sd_max_m);
  } else if (!(turn_sd_rad <= turn_sd_max_rad)) {
    what = "the rotation about " + camera_direction(turn.eigenvectors().col(2)) +
           fmt::format(
               " is not determined (standard deviation {:.2f} deg, but at most {:.2f} is allowed)",
               turn_sd_rad / kDeg, turn_sd_max_rad / kDeg);
  } else {
    return {};
  }
  if (motion.tilt_max_deg < 25.0) {
    return what +
           fmt::format(
               "; the board was tilted by {:.0f} deg at most between two views: tilt it more",
               motion.tilt_max_deg);
  }
  if (motion.out_of_plane < 0.15) {
    return what +
           "; the board was hardly tilted about a second axis: tilt it forward and back, too";
  }
  if (motion.distance_max_m < 1.15 * motion.distance_min_m) {
    return what + "; the distance of the board never changed: hold it nearer and farther, too";
  }
  return what + "; hold the board in more places and orientations";
}

}  // namespace orchard::calibration
