// SPDX-License-Identifier: BSD-3-Clause
#include "pose/scan_matching/scan_motion.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <variant>

#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"
#include "geometry/symmetric.hpp"
#include "pose/motion.hpp"
#include "pose/scan_matching/point_map.hpp"
#include "timing/units.hpp"

namespace orchard::pose {

using geometry::between;
using geometry::compose;
using geometry::compose_jacobian_first;
using geometry::rotation;
namespace {

// derived: pairs within 2 and 2.5 kernels; most scans converge in fewer iterations, which end at a
// fifth of a millimetre; a pose has three unknowns.
constexpr double kPairMax_m = 2.0 * kKernel_m;
constexpr double kPairFine_m = 2.5 * kKernelFine_m;
constexpr int kIterationsMax = 25;
constexpr double kDoneShift_m = 2e-4;
constexpr double kDoneTurn_rad = 2e-5;
constexpr int kPairsMin = 5;

// derived: budgets of the search. A robot that moved farther between two scans than the configured
// range, because some were lost, matches nothing there: the range is doubled this many times, each
// four times as costly. From one turn to the next no point moves by more than the kernel;
// candidates nearer than three steps converge to the same fit.
constexpr int kSearchCandidates = 6;
constexpr int kWiderSearches = 2;
constexpr double kSearchKernel_m = 0.3;
constexpr double kSearchShiftStep_m = 0.15;
constexpr std::size_t kSearchPoints = 120;
constexpr double kSameTurn_rad = 0.11;
constexpr double kSameShift_m = 0.45;

std::vector<SurfacePoint> every_nth(const std::vector<SurfacePoint>& points, std::size_t wanted) {
  const std::size_t step = std::max<std::size_t>(1, points.size() / wanted);
  std::vector<SurfacePoint> some;
  for (std::size_t i = 0; i < points.size(); i += step) some.push_back(points[i]);
  return some;
}

struct Place {
  Eigen::Vector3d T_map_base;
  double score = 0.0;

  bool is_near(const Place& other) const {
    return std::abs(geometry::wrap_angle_rad(T_map_base.z() - other.T_map_base.z())) <
               kSameTurn_rad &&
           (T_map_base - other.T_map_base).head<2>().norm() < kSameShift_m;
  }
};

/// Returns whether a fit lies within the search range, and as far beyond as it can be drawn. One
/// farther away has slid along a surface.
bool is_in_range(const ScanMatch& match, const Eigen::Vector3d& centre, double shift_m) {
  return (match.T_map_base - centre).head<2>().norm() <= shift_m + kPairMax_m;
}

constexpr double kResidualSd_m = 0.02;  ///< physical: roughness of surfaces

// physical: what no wheel and no clock tells of the motion between two scans.
constexpr double kLeastShiftSd_m = 0.005;
constexpr double kLeastTurnSd_rad = 0.002;

Eigen::Matrix3d least_motion() {
  return Eigen::Vector3d(kLeastShiftSd_m * kLeastShiftSd_m, kLeastShiftSd_m * kLeastShiftSd_m,
                         kLeastTurnSd_rad * kLeastTurnSd_rad)
      .asDiagonal();
}

// physical: standard deviation of the sideways motion that wheels do not tell, as a fraction of the
// travel: slip, and a scanner whose direction was set by eye. If wheels told that base never moves
// sideways, a scanner a degree off would bend every path to one side.
constexpr double kSideways = 0.1;

// derived: the search covers what the wheels leave open; chi-squared of three degrees of freedom
// at 99.9 %.
constexpr double kSearchSigmas = 3.0;
constexpr double kContradictionMax = 16.27;
// derived: the variance of the wheels' errors is learnt over some seconds of scans, as long as a
// turn lasts; one wrong fit may raise it by half.
constexpr double kSurpriseScans = 50.0;
constexpr double kSurpriseGrowth = 25.0;

// derived: shifted so far, informative points keep a fit of exp(-0.5 * 1.5^2) = 0.32.
constexpr double kProbeKernels = 1.5;

/// Returns the fraction of points that are informative on a shift along a direction, from the loss
/// of fit by that shift.
double telling_fraction(const ScanMatcher& matcher, const std::vector<SurfacePoint>& points,
                        const ScanMatch& match, const Eigen::Vector2d& direction, double kernel_m) {
  const double shift_m = kProbeKernels * kernel_m;
  double drop = 0.0;
  for (const double side : {-1.0, 1.0}) {
    Eigen::Vector3d moved = match.T_map_base;
    moved.head<2>() += side * shift_m * direction;
    drop += 0.5 * (match.score - matcher.score(points, moved, kernel_m));
  }
  const double drop_of_telling = 1.0 - std::exp(-0.5 * kProbeKernels * kProbeKernels);
  return std::clamp((drop / drop_of_telling - kFractionByChance) / (1.0 - kFractionByChance), 0.0,
                    1.0);
}

// derived: one return for each square, so that near surfaces, which get most, do not outweigh far
// ones [m]; drift does not double a wall within this travel [m].
constexpr double kThinning_m = 0.10;
constexpr int kPointsMin = 20;
constexpr double kMapTravel_m = 15.0;

// physical: a motion known as well between two scans still tells neighbouring trunks apart.
constexpr double kReliableShiftSd_m = 0.10;
constexpr double kReliableTurnSd_rad = 0.03;

bool is_sure(const Eigen::Matrix3d& covariance) {
  // Larger eigenvalue of the 2x2 position covariance.
  const double half_trace = 0.5 * (covariance(0, 0) + covariance(1, 1));
  const double deviation =
      std::hypot(0.5 * (covariance(0, 0) - covariance(1, 1)), covariance(0, 1));
  return half_trace + deviation <= kReliableShiftSd_m * kReliableShiftSd_m &&
         covariance(2, 2) <= kReliableTurnSd_rad * kReliableTurnSd_rad;
}

}  // namespace

double ScanMatcher::score(const std::vector<SurfacePoint>& points,
                          const Eigen::Vector3d& T_map_base, double kernel_m) const {
  if (points.empty()) return 0.0;
  const Eigen::Matrix2d R = rotation(T_map_base.z());
  const double scale = -0.5 / (kernel_m * kernel_m);
  double sum = 0.0;
  for (const SurfacePoint& point : points) {
    double d2 = 0.0;
    if (map_.nearest(R * point.p + T_map_base.head<2>(), 2.0 * kernel_m, d2)) {
      sum += std::exp(scale * d2);
    }
  }
  return sum / static_cast<double>(points.size());
}

void ScanMatcher::iterate(const std::vector<SurfacePoint>& points, double pair_m, double kernel_m,
                          ScanMatch& match) const {
  const double kernel2 = kernel_m * kernel_m;
  for (int round = 0; round < kIterationsMax; ++round) {
    const Eigen::Vector3d& T = match.T_map_base;
    const Eigen::Matrix2d R = rotation(T.z());
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    int pairs = 0;
    double squares = 0.0, weights = 0.0;
    for (const SurfacePoint& point : points) {
      const Eigen::Vector2d arm = R * point.p;
      const Eigen::Vector2d p = arm + T.head<2>();
      double d2 = 0.0;
      const SurfacePoint* partner = map_.nearest(p, pair_m, d2);
      if (!partner) continue;
      const Eigen::Vector2d residual = p - partner->p;
      Eigen::Matrix2d across = Eigen::Matrix2d::Identity();
      Eigen::Matrix2d metric = across;
      if (partner->flat) {
        across = partner->normal * partner->normal.transpose();
        metric = (1.0 - kAlongFraction) * across + kAlongFraction * Eigen::Matrix2d::Identity();
      }
      const double r2 = residual.dot(metric * residual);
      // Geman-McClure
      const double fraction = kernel2 / (kernel2 + r2);
      const double weight = fraction * fraction;
      const Eigen::Matrix<double, 2, 3> J = geometry::point_jacobian(arm);
      const Eigen::Matrix<double, 3, 2> Jt = weight * J.transpose();
      H += Jt * metric * J;
      information += Jt * across * J;
      gradient += Jt * metric * residual;
      squares += weight * r2;
      weights += weight;
      ++pairs;
    }
    match.matched = static_cast<double>(pairs) / static_cast<double>(points.size());
    match.information = information;
    match.weight = weights;
    match.residual_variance_m2 = weights > 0.0 ? squares / weights : 0.0;
    if (pairs < kPairsMin) return;
    H.diagonal() += Eigen::Vector3d(1e-6, 1e-6, 1e-6);
    const Eigen::Vector3d step = -geometry::solve_symmetric(H, gradient);
    if (!step.allFinite()) return;
    match.T_map_base += step;
    if (step.head<2>().norm() < kDoneShift_m && std::abs(step.z()) < kDoneTurn_rad) return;
  }
}

ScanMatch ScanMatcher::refined(const std::vector<SurfacePoint>& points,
                               const Eigen::Vector3d& guess) const {
  ScanMatch match;
  match.T_map_base = guess;
  iterate(points, kPairMax_m, kKernel_m, match);
  iterate(points, kPairFine_m, kKernelFine_m, match);
  match.T_map_base.z() = geometry::wrap_angle_rad(match.T_map_base.z());
  match.score = score(points, match.T_map_base, kScoreKernel_m);
  return match;
}

ScanMatch ScanMatcher::unmatched(const std::vector<SurfacePoint>& points,
                                 const Eigen::Vector3d& T_map_base) const {
  ScanMatch match;
  match.T_map_base = T_map_base;
  match.score = score(points, T_map_base, kScoreKernel_m);
  return match;
}

ScanMatch ScanMatcher::searched(const std::vector<SurfacePoint>& points,
                                const Eigen::Vector3d& centre, double shift_m, double turn_rad,
                                const ScanMatch& found) const {
  const std::vector<SurfacePoint> some = every_nth(points, kSearchPoints);
  double farthest_m = kSearchKernel_m;
  for (const SurfacePoint& point : some) farthest_m = std::max(farthest_m, point.p.norm());
  const LikelihoodField raster(map_, centre.head<2>(), farthest_m + shift_m, kSearchKernel_m);
  const double turn_step_rad = kSearchKernel_m / farthest_m;
  const int turns = static_cast<int>(std::ceil(turn_rad / turn_step_rad));
  const int shifts = static_cast<int>(std::ceil(shift_m / kSearchShiftStep_m));
  std::vector<Place> places;
  std::vector<Eigen::Vector2d> arms_map(some.size());
  for (int turn = -turns; turn <= turns; ++turn) {
    const double yaw_rad = centre.z() + turn * turn_step_rad;
    const Eigen::Matrix2d R = rotation(yaw_rad);
    for (std::size_t i = 0; i < some.size(); ++i) arms_map[i] = R * some[i].p;
    for (int x = -shifts; x <= shifts; ++x) {
      for (int y = -shifts; y <= shifts; ++y) {
        const Eigen::Vector2d base_map =
            centre.head<2>() + kSearchShiftStep_m * Eigen::Vector2d(x, y);
        places.push_back({{base_map.x(), base_map.y(), yaw_rad}, raster.score(arms_map, base_map)});
      }
    }
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const Place& a, const Place& b) { return a.score > b.score; });
  std::vector<Place> tried;
  ScanMatch best = found;
  best.score = score(some, found.T_map_base, kScoreKernel_m);
  const double score_to_beat = best.score;
  for (const Place& place : places) {
    if (static_cast<int>(tried.size()) >= kSearchCandidates) break;
    if (std::any_of(tried.begin(), tried.end(),
                    [&place](const Place& other) { return place.is_near(other); })) {
      continue;
    }
    tried.push_back(place);
    const ScanMatch match = refined(some, place.T_map_base);
    if (match.score > best.score && is_in_range(match, centre, shift_m)) best = match;
  }
  if (best.score <= score_to_beat) return found;
  best = refined(points, best.T_map_base);
  return best.score > found.score + kScoreAdvantage && is_in_range(best, centre, shift_m) ? best
                                                                                          : found;
}

ScanMatch ScanMatcher::match(const std::vector<SurfacePoint>& points,
                             const std::vector<Eigen::Vector3d>& guesses, double shift_max_m,
                             double turn_max_rad) const {
  const Eigen::Vector3d* start = &guesses.front();
  double best_score = -1.0;
  for (const Eigen::Vector3d& guess : guesses) {
    if (guesses.size() == 1) break;  // nothing to choose
    const double fit = score(points, guess, kSearchKernel_m);
    if (fit > best_score + 0.01) {
      best_score = fit;
      start = &guess;
    }
  }
  ScanMatch match = refined(points, *start);
  double shift_m = shift_max_m;
  if (!is_in_range(match, *start, shift_m)) match = unmatched(points, guesses.front());
  if (match.score >= kScoreGood) return match;
  match = searched(points, guesses.front(), shift_m, turn_max_rad, match);
  for (int i = 0; i < kWiderSearches && match.score < kScoreReliable; ++i) {
    shift_m *= 2.0;
    const ScanMatch wider = searched(points, guesses.front(), shift_m, turn_max_rad, match);
    if (wider.score >= kScoreReliable) match = wider;
  }
  return match;
}

Eigen::Matrix3d information_of(const ScanMatcher& matcher, const std::vector<SurfacePoint>& points,
                               const ScanMatch& match) {
  const double weight = match.weight;
  if (!(weight > 0.0) || !match.information.allFinite()) return Eigen::Matrix3d::Zero();
  Eigen::Matrix3d information = match.information;
  const geometry::Axes2 axes = geometry::axes_of(match.information.topLeftCorner<2, 2>());
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d direction = axes.directions.col(axis);
    const double claimed = std::max(0.0, axes.values(axis)) / weight;
    const double fraction = telling_fraction(matcher, points, match, direction, kScoreKernel_m);
    if (!(claimed > 0.0) || fraction >= claimed) continue;
    // Scale the information along the direction (and its correlation) by fraction / claimed.
    Eigen::Matrix3d scale = Eigen::Matrix3d::Identity();
    scale.topLeftCorner<2, 2>() -=
        (1.0 - std::sqrt(fraction / claimed)) * direction * direction.transpose();
    information = scale * information * scale;
  }
  const double floor_m2 = kResidualSd_m * kResidualSd_m;
  return information / (kCorrelatedPoints * std::max(match.residual_variance_m2, floor_m2));
}

Eigen::Matrix3d covariance_of(const ScanMatcher& matcher, const std::vector<SurfacePoint>& points,
                              const ScanMatch& match) {
  const Eigen::Matrix3d nothing = unknown_motion();
  const Eigen::Matrix3d total = information_of(matcher, points, match) +
                                Eigen::Matrix3d(nothing.diagonal().cwiseInverse().asDiagonal());
  const Eigen::Matrix3d covariance = total.inverse();
  if (!covariance.allFinite()) return nothing;
  return 0.5 * (covariance + covariance.transpose());
}

ScanMotion::ScanMotion(const PoseConfig& config, const laser::LaserConfig& mount,
                       const laser::BlindSector& blind)
    : config_(config.scan_motion),
      wheels_sd_(config.slam.speed_scale_sd, config.slam.turn_scale_sd,
                 config.slam.yaw_rate_bias_sd_radps),
      wheels_(config.slam),
      mount_(mount),
      blind_(blind),
      map_(config_) {
  wheels_.set_default_noise(config.speed_sd_fraction, config.yaw_rate_sd_radps);
}

ScanMotion::Expected ScanMotion::expected_at(std::int64_t utime) {
  Expected expected;
  if (wheels_.started()) {
    wheels_.advance_to(utime);
    if (wheels_.time_since_motion_s() <= PoseConfig::kOdometryGapMax_s) {
      const RelativeMotion& m = wheels_.motion();
      const Eigen::Matrix3d lasting = m.calibration_jacobian * wheels_sd_.asDiagonal();
      Eigen::Matrix3d covariance = m.covariance + lasting * lasting.transpose() + least_motion();
      covariance(1, 1) += geometry::square(kSideways * m.travel_m);
      covariance *= surprise_;
      expected.T_from_to = m.delta;
      expected.calibration_jacobian = m.calibration_jacobian;
      expected.is_guess = false;
      expected.is_measured =
          (covariance.diagonal().array() <= expected.covariance.diagonal().array()).all();
      if (expected.is_measured) {
        expected.covariance = covariance;
        expected.covariance_calibrated = surprise_ * m.covariance;
        expected.P_weighed = expected.P_base =
            compose_covariance(Eigen::Vector3d::Zero(), P_base_, m.delta, covariance);
      }
    }
  }
  if (expected.is_guess && utime_) {
    const SteadyMotion::Forecast steady = steady_.forecast(timing::seconds(utime - *utime_));
    expected.T_from_to = steady.T_from_to;
    expected.P_weighed = steady.covariance + least_motion();
  }
  return expected;
}

ScanMotion::After ScanMotion::matched(const laser::Scan& scan, const Expected& expected,
                                      const std::optional<Eigen::Vector3d>& predicted,
                                      std::vector<SurfacePoint>& points) const {
  After after;
  MeasuredMotion& motion = after.motion;
  motion.utime_from = *utime_;
  motion.utime_to = scan.utime;
  motion.T_from_to = expected.T_from_to;
  motion.covariance = expected.covariance;
  motion.covariance_calibrated = expected.covariance_calibrated;
  motion.calibration_jacobian = expected.calibration_jacobian;
  motion.is_guess = expected.is_guess;
  const Eigen::Vector3d T_map_before = T_map_base_;
  const Eigen::Vector3d T_expected = compose(T_map_before, expected.T_from_to);
  const Eigen::Matrix3d F = compose_jacobian_first(Eigen::Vector3d::Zero(), expected.T_from_to);
  const Eigen::Matrix3d D_before = F * D_base_;
  const Eigen::Matrix3d P_before = F * P_base_ * F.transpose();
  after.T_map_base = T_expected;
  after.P_base = expected.P_base;
  after.D_base = D_before + expected.calibration_jacobian;
  after.surprise = surprise_;
  std::vector<SurfacePoint> few = thinned(points, kThinning_m);
  if (static_cast<int>(few.size()) < kPointsMin || map_.empty()) return after;

  std::vector<Eigen::Vector3d> guesses{T_expected};
  double shift_max_m = config_.search_shift_m, turn_max_rad = geometry::kPi;
  if (expected.is_measured) {
    shift_max_m = std::min(
        shift_max_m, kSearchSigmas * std::sqrt(expected.P_base.topLeftCorner<2, 2>().trace()));
    turn_max_rad = std::min(geometry::kPi, kSearchSigmas * std::sqrt(expected.P_base(2, 2)));
  } else {
    // Wheels that are doubted may be worse than no wheels, so the last motion is tried beside them.
    const Eigen::Vector3d on = expected.is_guess ? expected.T_from_to : steady_.last();
    if (!expected.is_guess) guesses.push_back(compose(T_map_before, on));
    guesses.push_back(compose(T_map_before, {on.x(), on.y(), 0.0}));
    guesses.push_back(T_map_before);
    if (predicted) guesses.push_back(compose(T_map_before, *predicted));
  }
  const ScanMatcher matcher(map_);
  ScanMatch match = matcher.match(few, guesses, shift_max_m, turn_max_rad);
  if (config_.deskew && scan.beam_period_us > 0.0 && velocity_known_) {
    const Eigen::Vector3d velocity =
        between(T_map_before, match.T_map_base) / timing::seconds(scan.utime - *utime_);
    points = surface_points(scan, mount_, blind_, velocity, config_);
    few = thinned(points, kThinning_m);
    match = matcher.match(few, {match.T_map_base}, shift_max_m, turn_max_rad);
  }
  motion.matched = match.matched;

  // In the axes of map, about the robot.
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(T_map_before.z());
  const Eigen::Matrix3d told = information_of(matcher, few, match);
  Eigen::Matrix3d known = R * expected.P_weighed.inverse() * R.transpose();
  Eigen::Matrix3d P = (told + known).inverse();
  Eigen::Vector3d apart = match.T_map_base - T_expected;
  apart.z() = geometry::wrap_angle_rad(apart.z());
  if (!P.allFinite() || !apart.allFinite()) return after;
  const double distance2 = apart.dot((known - known * P * known) * apart);
  if (expected.is_measured) {
    const double ratio = std::min(surprise_ * distance2 / 3.0, kSurpriseGrowth * surprise_);
    after.surprise = std::max(1.0, surprise_ + (ratio - surprise_) / kSurpriseScans);
  }
  const Eigen::Matrix3d unknown = unknown_motion().inverse();
  const bool is_impossible = expected.is_guess && apart.dot(unknown * apart) > kContradictionMax;
  const bool is_contradicted = expected.is_measured ? distance2 > kContradictionMax : is_impossible;
  // A good fit tells that the wheels slip; a poor one that contradicts them is none. Nor is one to
  // which no return is drawn from where the wheels expect it: along a row the next trunk fits, too.
  const bool is_elsewhere = apart.head<2>().norm() > kPairMax_m;
  if (is_contradicted) known = unknown;
  // A robot turns and stops: the farther a scan is from what was foretold, the less that weighs.
  if (expected.is_guess) known = known / std::max(1.0, distance2 / 3.0) + unknown;
  P = (told + known).inverse();
  const bool is_taken =
      !is_contradicted || (!is_impossible && match.score >= kScoreGood && !is_elsewhere);
  motion.has_place = is_taken || !expected.is_measured;
  if (!motion.has_place) return after;
  const Eigen::Matrix3d gain = is_taken ? Eigen::Matrix3d(P * told) : Eigen::Matrix3d::Zero();
  after.T_map_base = T_expected + gain * apart;
  motion.T_from_to = between(T_map_before, after.T_map_base);
  // What the last motions foretell is no measurement of this one.
  if (expected.is_guess) P = (told + unknown).inverse();
  if (is_contradicted) P += apart * apart.transpose();
  after.P_base = R.transpose() * P * R;
  after.P_base = 0.5 * (after.P_base + after.P_base.transpose()).eval();
  motion.reliable = match.score >= kScoreReliable && is_sure(P) && !is_contradicted;
  motion.is_guess = expected.is_guess && !motion.reliable;
  motion.covariance = motion.covariance_calibrated = after.P_base;
  Eigen::Matrix3d K = R.transpose() * gain * R;
  const Eigen::Matrix3d unfitted = Eigen::Matrix3d::Identity() - K;
  after.D_base = (unfitted * after.D_base).eval();
  if (expected.is_measured && !is_contradicted && was_reliable_) {
    const Eigen::Matrix3d lasting =
        unfitted * expected.calibration_jacobian * wheels_sd_.asDiagonal();
    motion.covariance_calibrated -= lasting * lasting.transpose();
  } else if (expected.is_measured && !is_contradicted) {
    // What a good fit after poor ones mends has grown over all the motions since: this one answers
    // for its share of it, as a smoother divides it, and the others stay as the wheels told them.
    const Eigen::Matrix3d share = expected.covariance * expected.P_base.inverse();
    const Eigen::Matrix3d by_fit = share * R.transpose() * P;
    K = share * K;
    const Eigen::Matrix3d left = Eigen::Matrix3d::Identity() - K;
    const Eigen::Matrix3d P_fit = by_fit * told * by_fit.transpose() + K * P_before * K.transpose();
    motion.T_from_to = between(T_map_before, T_expected + R * K * R.transpose() * apart);
    motion.covariance = left * expected.covariance * left.transpose() + P_fit;
    motion.covariance_calibrated = left * expected.covariance_calibrated * left.transpose() + P_fit;
  }
  motion.calibration_jacobian =
      expected.calibration_jacobian - K * (D_before + expected.calibration_jacobian);
  return after;
}

std::optional<MeasuredMotion> ScanMotion::add(const laser::Scan& scan,
                                              const std::optional<Eigen::Vector3d>& predicted) {
  if (utime_ && scan.utime <= *utime_) return std::nullopt;
  const Expected expected = expected_at(scan.utime);
  std::vector<SurfacePoint> points = surface_points(scan, mount_, blind_, velocity_, config_);
  if (!utime_) {
    utime_ = scan.utime;
    remember(points);
    return std::nullopt;
  }
  const After after = matched(scan, expected, predicted, points);
  const MeasuredMotion& motion = after.motion;
  surprise_ = after.surprise;
  if (!motion.has_place) return motion;
  wheels_.restart(OdometryCalibration::Zero());
  const double yaw_before_rad = T_map_base_.z();
  T_map_base_ = after.T_map_base;
  T_map_base_.z() = geometry::wrap_angle_rad(T_map_base_.z());
  travel_m_ += motion.T_from_to.head<2>().norm();
  steady_.add(motion.T_from_to, timing::seconds(scan.utime - *utime_), motion.reliable);
  velocity_ = motion.T_from_to / timing::seconds(scan.utime - *utime_);
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(yaw_before_rad - T_map_base_.z());
  P_base_ = R * after.P_base * R.transpose();
  D_base_ = R * after.D_base;
  was_reliable_ = motion.reliable;
  utime_ = scan.utime;
  if (config_.deskew && scan.beam_period_us > 0.0 && !velocity_known_) {
    // The first scan was not deskewed because the velocity was unknown: restart the map.
    map_.clear();
    points = surface_points(scan, mount_, blind_, velocity_, config_);
  }
  velocity_known_ = true;
  remember(points);
  return motion;
}

void ScanMotion::remember(const std::vector<SurfacePoint>& points) {
  if (kMapTravel_m > 0.0) map_.forget_before(travel_m_ - kMapTravel_m);
  const Eigen::Matrix2d R = rotation(T_map_base_.z());
  for (const SurfacePoint& point : points) {
    SurfacePoint placed = point;
    placed.p = R * point.p + T_map_base_.head<2>();
    placed.normal = R * point.normal;
    map_.insert(placed, travel_m_);
  }
}

void ScanOdometry::add(const Measurement& measurement) {
  if (const auto* odometry = std::get_if<Odometry>(&measurement)) motion_.add(*odometry);
  const auto* scan = std::get_if<laser::Scan>(&measurement);
  if (!scan) return;
  const Eigen::Vector3d T_map_before = motion_.T_map_base();
  const std::optional<MeasuredMotion> motion = motion_.add(*scan);
  if (!motion) {
    if (!utime_) utime_ = scan->utime;
    return;
  }
  num_unreliable_ = motion->reliable ? 0 : num_unreliable_ + 1;
  if (!motion->has_place) return;
  covariance_ =
      compose_covariance(T_map_before, covariance_, motion->T_from_to, motion->covariance);
  utime_ = motion->utime_to;
}

std::optional<PoseEstimate> ScanOdometry::estimate() const {
  if (!utime_) return std::nullopt;
  return pose_estimate(*utime_, motion_.T_map_base(), covariance_);
}

std::string ScanOdometry::warning() const {
  if (num_unreliable_ == 0) return {};
  return "LOST: the last " + std::to_string(num_unreliable_) +
         " scans could not be matched (too few returns, no overlap with earlier scans, or only "
         "smooth walls); the path is extrapolated from there on";
}

}  // namespace orchard::pose
