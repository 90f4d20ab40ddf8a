// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/board/board_association.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "calibration/tuning.hpp"
#include "geometry/angles.hpp"
#include "geometry/statistics.hpp"

namespace orchard::calibration {
namespace {

struct Beam {
  std::size_t index = 0;
  double range_m = 0.0;
  double bearing_rad = 0.0;
  Eigen::Vector2d point_m;
};
using Beams = std::vector<Beam>;

struct Fit {
  Eigen::Vector2d centre_m;
  Eigen::Vector2d direction;
  double off_m(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d d = p - centre_m;
    return std::abs(d.x() * direction.y() - d.y() * direction.x());
  }
  double along_m(const Eigen::Vector2d& p) const { return direction.dot(p - centre_m); }
};

Fit fit_line(const Beam* first, const Beam* last) {
  Fit fit;
  fit.centre_m.setZero();
  for (const Beam* b = first; b != last; ++b) fit.centre_m += b->point_m;
  fit.centre_m /= static_cast<double>(last - first);
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const Beam* b = first; b != last; ++b) {
    const Eigen::Vector2d d = b->point_m - fit.centre_m;
    scatter += d * d.transpose();
  }
  fit.direction = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(scatter).eigenvectors().col(1);
  if (fit.direction.dot((last - 1)->point_m - first->point_m) < 0.0) fit.direction *= -1.0;
  return fit;
}

class LineFinder {
 public:
  LineFinder(const laser::Scan& scan, const BoardLineSearch& search)
      : scan_(scan), search_(search) {}

  std::vector<BoardLine> find() {
    const std::vector<Beams> runs = split_at_jumps();
    noise_factor_ = estimate_noise(runs);
    std::vector<BoardLine> lines;
    for (const Beams& run : runs) {
      std::vector<std::size_t> cuts{0};
      split(run, 0, run.size(), cuts);
      merge(run, cuts);
      for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        if (auto line = make_line(run, cuts[i], cuts[i + 1])) lines.push_back(std::move(*line));
      }
    }
    return lines;
  }

 private:
  double sd_m(double range_m) const {
    return std::max(5e-4,
                    noise_factor_ * (search_.range_sd_m + search_.range_sd_fraction * range_m));
  }

  std::vector<Beams> split_at_jumps() const {
    std::vector<Beams> runs;
    for (std::size_t i = 0; i < scan_.ranges_m.size(); ++i) {
      if (!scan_.valid(i) || scan_.ranges_m[i] > search_.range_max_m) continue;
      Beam beam;
      beam.index = i;
      beam.range_m = scan_.ranges_m[i];
      beam.bearing_rad = scan_.bearing_rad(static_cast<double>(i));
      beam.point_m =
          beam.range_m * Eigen::Vector2d(std::cos(beam.bearing_rad), std::sin(beam.bearing_rad));
      const bool joins = !runs.empty() && i - runs.back().back().index <= 2 &&
                         std::abs(beam.range_m - runs.back().back().range_m) <
                             0.06 + 0.02 * std::min(beam.range_m, runs.back().back().range_m);
      if (!joins) runs.emplace_back();
      runs.back().push_back(beam);
    }
    return runs;
  }

  /// Ratio of actual to stated beam noise, from second differences of neighbouring ranges.
  double estimate_noise(const std::vector<Beams>& runs) const {
    std::vector<double> fractions;
    for (const Beams& run : runs) {
      for (std::size_t i = 1; i + 1 < run.size(); ++i) {
        const double bend = run[i - 1].range_m - 2.0 * run[i].range_m + run[i + 1].range_m;
        const double stated = search_.range_sd_m + search_.range_sd_fraction * run[i].range_m;
        if (stated > 0.0) fractions.push_back(std::abs(bend) / (0.6745 * std::sqrt(6.0) * stated));
      }
    }
    return std::clamp(geometry::median(std::move(fractions)), 0.02, 1.0);
  }

  double tolerance_m(const Beam& beam) const { return 4.5 * sd_m(beam.range_m) + 1e-3; }

  /// Appends the ends (exclusive) of the straight segments in [first, last).
  void split(const Beams& run, std::size_t first, std::size_t last,
             std::vector<std::size_t>& cuts) const {
    if (last - first >= 4) {
      // Average several beams at each end, so that one noisy beam does not rotate the chord.
      const std::size_t n = std::min<std::size_t>(3, (last - first) / 4 + 1);
      Eigen::Vector2d a = Eigen::Vector2d::Zero(), b = a;
      for (std::size_t i = 0; i < n; ++i) {
        a += run[first + i].point_m;
        b += run[last - 1 - i].point_m;
      }
      Fit chord;
      chord.centre_m = a / static_cast<double>(n);
      chord.direction = (b - a).normalized();
      std::size_t worst = first;
      double worst_m = 0.0;
      for (std::size_t i = first; i < last; ++i) {
        const double off = chord.off_m(run[i].point_m) / tolerance_m(run[i]);
        if (off > worst_m) {
          worst_m = off;
          worst = i;
        }
      }
      if (worst_m > 1.0) {
        const std::size_t cut = std::clamp(worst, first + 1, last - 1);
        split(run, first, cut, cuts);
        split(run, cut, last, cuts);
        return;
      }
    }
    cuts.push_back(last);
  }

  bool straight(const Beams& run, std::size_t first, std::size_t last) const {
    const Fit fit = fit_line(&run[first], &run[first] + (last - first));
    std::size_t num_off = 0;
    double sum = 0.0;
    for (std::size_t i = first; i < last; ++i) {
      const double off = fit.off_m(run[i].point_m) / sd_m(run[i].range_m);
      sum += std::min(off * off, 9.0);
      if (off > 3.5) ++num_off;
    }
    const double n = static_cast<double>(last - first);
    return static_cast<double>(num_off) <= 0.03 * n + 1.0 && sum <= 1.6 * n;
  }

  void merge(const Beams& run, std::vector<std::size_t>& cuts) const {
    for (bool merged = true; merged && cuts.size() > 2;) {
      merged = false;
      for (std::size_t i = 1; i + 1 < cuts.size(); ++i) {
        if (!straight(run, cuts[i - 1], cuts[i + 1])) continue;
        cuts.erase(cuts.begin() + static_cast<std::ptrdiff_t>(i));
        merged = true;
        break;
      }
    }
  }

  std::optional<BoardLine> make_line(const Beams& run, std::size_t first, std::size_t last) const {
    if (last - first < static_cast<std::size_t>(search_.min_beams)) return std::nullopt;
    Beams beams(run.begin() + static_cast<std::ptrdiff_t>(first),
                run.begin() + static_cast<std::ptrdiff_t>(last));
    Fit fit = fit_line(beams.data(), beams.data() + beams.size());
    for (int round = 0; round < 3; ++round) {
      std::vector<double> off;
      for (const Beam& beam : beams) off.push_back(fit.off_m(beam.point_m));
      const double limit_m = std::max(1e-3, 3.0 * geometry::kMadToSd * geometry::median(off));
      Beams kept;
      for (const Beam& beam : beams) {
        if (fit.off_m(beam.point_m) <= limit_m) kept.push_back(beam);
      }
      if (kept.size() < static_cast<std::size_t>(search_.min_beams)) return std::nullopt;
      const bool same = kept.size() == beams.size();
      beams = std::move(kept);
      fit = fit_line(beams.data(), beams.data() + beams.size());
      if (same) break;
    }
    BoardLine line;
    double sum = 0.0, sd_sum = 0.0;
    for (const Beam& beam : beams) {
      line.ranges_m.push_back(beam.range_m);
      line.bearings_rad.push_back(beam.bearing_rad);
      sum += fit.off_m(beam.point_m) * fit.off_m(beam.point_m);
      sd_sum += sd_m(beam.range_m) * sd_m(beam.range_m);
    }
    if (sum > 2.5 * sd_sum) return std::nullopt;  // curved
    const double n = static_cast<double>(beams.size());
    line.rms_m = std::sqrt(sum / n);
    const double from_m = fit.along_m(beams.front().point_m);
    const double to_m = fit.along_m(beams.back().point_m);
    line.direction = fit.direction;
    line.middle_m = fit.centre_m + 0.5 * (from_m + to_m) * fit.direction;
    line.length_m = (to_m - from_m) * n / (n - 1.0);  // half a beam step at each end
    if (line.length_m < search_.length_min_m || line.length_m > search_.length_max_m) {
      return std::nullopt;
    }
    line.start = end_at(beams.front(), -1);
    line.end = end_at(beams.back(), +1);
    return line;
  }

  /// Whether the beam beyond an edge is a mixed pixel, with a range between edge and next surface.
  bool mixed_at(std::ptrdiff_t i, int step, double edge_range_m) const {
    const std::ptrdiff_t next = i + step;
    if (next < 0 || next >= static_cast<std::ptrdiff_t>(scan_.ranges_m.size())) return false;
    if (!scan_.valid(static_cast<std::size_t>(next))) return false;
    const double range_m = scan_.ranges_m[static_cast<std::size_t>(i)];
    const double behind_m = scan_.ranges_m[static_cast<std::size_t>(next)];
    return behind_m - range_m > std::max(0.15, 0.2 * (behind_m - edge_range_m));
  }

  /// Searches outwards from the last beam of a line for the edge: the first larger range.
  LineEnd end_at(const Beam& last, int step) const {
    LineEnd end;
    const auto size = static_cast<std::ptrdiff_t>(scan_.ranges_m.size());
    // physical: a laser spot covers at most two beam steps.
    constexpr std::ptrdiff_t kMixed = 2;  // max number of mixed pixels
    for (std::ptrdiff_t k = 1; k <= kMixed + 1; ++k) {
      const std::ptrdiff_t i = static_cast<std::ptrdiff_t>(last.index) + k * step;
      if (i < 0 || i >= size) return end;
      const double bearing_rad = scan_.bearing_rad(static_cast<double>(i));
      const bool nothing = !scan_.valid(static_cast<std::size_t>(i));
      const double range_m = scan_.ranges_m[static_cast<std::size_t>(i)];
      if (!nothing && range_m < last.range_m - 0.05) return end;  // hidden by a nearer object
      if (nothing || range_m > last.range_m + 0.15) {
        end.seen = true;
        if (!nothing && mixed_at(i, step, last.range_m)) {
          // The spot lies on both surfaces, so the beam is on the edge, not beyond it.
          end.bearing_rad = bearing_rad;
          end.half_gap_rad = 0.5 * std::abs(scan_.bearing_step_rad);
        } else {
          end.bearing_rad = 0.5 * (last.bearing_rad + bearing_rad);
          end.half_gap_rad = 0.5 * std::abs(bearing_rad - last.bearing_rad);
        }
        return end;
      }
    }
    return end;
  }

  const laser::Scan& scan_;
  const BoardLineSearch& search_;
  double noise_factor_ = 1.0;
};

}  // namespace

std::vector<BoardLine> find_board_lines(const laser::Scan& scan, const BoardLineSearch& search) {
  return LineFinder(scan, search).find();
}

namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

Eigen::Vector3d in_space(const Eigen::Vector2d& p) { return {p.x(), p.y(), 0.0}; }

std::vector<Eigen::Matrix3d> all_rotations() {
  std::vector<Eigen::Matrix3d> rotations;
  const int num_axes =
      static_cast<int>(4.0 * geometry::kPi / (tuning::kGrid_rad * tuning::kGrid_rad));
  const int num_turns = static_cast<int>(2.0 * geometry::kPi / tuning::kGrid_rad) + 1;
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
        const double off = n_laser.head<2>().dot(line.direction) / tuning::kDirectionGate;
        least = std::min(least, off * off);
      }
      cost += least;
    }
    return cost;
  }

  RigidExtrinsics refine(const Eigen::Matrix3d& start) const {
    RigidExtrinsics mount;
    mount.R_camera_laser = start;
    double gate_m = tuning::kWideGate_m;
    for (int round = 0; round < 4; ++round) mount = step(mount, 1e3, true);
    for (int round = 0; round < 24; ++round) {
      mount = step(mount, gate_m, false);
      gate_m = std::max(tuning::kGate_m, 0.85 * gate_m);
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
    return p.x() > outline_.x_min_m - tuning::kOutsideBoard_m &&
           p.x() < outline_.x_max_m + tuning::kOutsideBoard_m &&
           p.y() > outline_.y_min_m - tuning::kOutsideBoard_m &&
           p.y() < outline_.y_max_m + tuning::kOutsideBoard_m;
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
    next.R_camera_laser = rotation_of(change.tail<3>()) * mount.R_camera_laser;
    return next;
  }

  const std::vector<ExtrinsicsView>& views_;
  const BoardOutline& outline_;
  std::vector<Plane> planes_;
};

bool same_mount(const RigidExtrinsics& a, const RigidExtrinsics& b) {
  return angle_between(a.R_camera_laser, b.R_camera_laser) < tuning::kSameRotation_rad &&
         (a.delta_m - b.delta_m).norm() < tuning::kSameShift_m;
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
    if (static_cast<int>(tried.size()) >= tuning::kMaxStarts) break;
    const bool near = std::any_of(tried.begin(), tried.end(), [&](const Eigen::Matrix3d& R) {
      return angle_between(R, start.R) < 0.9 * tuning::kGrid_rad;
    });
    if (near) continue;
    tried.push_back(start.R);
    Association found;
    const double cost = matcher.judge(matcher.refine(start.R), tuning::kGate_m, found);
    all.push_back(found.mount);
    if (cost < best_cost) {
      best_cost = cost;
      best = std::move(found);
    }
  }
  // A rival explains the views equally well only if its lines are as close to the boards.
  const double num_missing = static_cast<double>(views.size()) - best.num_fitting;
  const double best_rms_m = tuning::kGate_m * std::sqrt(std::max(0.0, best_cost - num_missing) /
                                                        std::max(1, best.num_fitting));
  const double rival_gate_m =
      std::clamp(3.0 * best_rms_m, tuning::kMinRivalGate_m, tuning::kGate_m);
  for (const RigidExtrinsics& mount : all) {
    if (same_mount(mount, best.mount)) continue;
    Association rival;
    matcher.judge(mount, rival_gate_m, rival);
    best.rival_fitting = std::max(best.rival_fitting, rival.num_fitting);
  }
  return best;
}

}  // namespace orchard::calibration
