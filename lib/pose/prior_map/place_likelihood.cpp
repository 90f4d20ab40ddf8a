// SPDX-License-Identifier: BSD-3-Clause
#include "pose/prior_map/place_likelihood.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"
#include "geometry/symmetric.hpp"
#include "pose/motion.hpp"
#include "pose/pose_config.hpp"

namespace orchard::pose {
namespace {

using geometry::square;

// derived: fractions of the landmarks in view that are seen, alike likely; beyond this a landmark
// adds nothing to an observation; the radius in which observations are counted for the density of
// clutter [m], that of a plant with its shoots; cells fine for two landmarks' errors [m].
constexpr std::array<double, 5> kFractions{0.1, 0.3, 0.5, 0.7, 0.9};
constexpr double kReachSigmas = 3.5;
constexpr double kClutter_m = 1.0;
constexpr double kViewCell_m = 2.0 * PriorMapConfig::kLandmarkSd_m;

// derived: a Gaussian of a quarter of the spacing has one partner for a trunk, also if its heading
// errs by as much at two spacings.
constexpr double kPlaceSpacings = 0.25;
constexpr double kPlaceSd_rad = 0.5 * kPlaceSpacings;

float distance_m(const std::vector<ScanObservation>& observations, const Eigen::Vector2d& p_base) {
  double d2 = std::numeric_limits<float>::max();
  for (const ScanObservation& s : observations) {
    d2 = std::min(d2, (s.p_base - p_base).squaredNorm());
  }
  return static_cast<float>(std::sqrt(d2));
}

}  // namespace

void WeighedPlace::move(const Eigen::Vector3d& T_base_next,
                        const Eigen::Matrix3d& covariance_next) {
  covariance = compose_covariance(T_map_base, covariance, T_base_next, covariance_next);
  T_map_base = geometry::compose(T_map_base, T_base_next);
  T_map_base.z() = geometry::wrap_angle_rad(T_map_base.z());
}

Eigen::Vector3d pose_difference(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  Eigen::Vector3d d = a - b;
  d.z() = geometry::wrap_angle_rad(d.z());
  return d;
}

Eigen::Vector3d stepped(const Eigen::Vector3d& T, const Eigen::Vector3d& step) {
  return {T.x() + step.x(), T.y() + step.y(), geometry::wrap_angle_rad(T.z() + step.z())};
}

/// Products over the landmarks in view, one for each fraction of them that is seen.
class PlaceLikelihood::SeenAndMissed {
 public:
  SeenAndMissed() { products_.fill(1.0); }

  /// A landmark that another visit sees with probability `repeat`: `ratio` is the density of the
  /// observations as this landmark over that as clutter, 0 if it is missed.
  void add(double ratio, double repeat) {
    for (std::size_t i = 0; i < products_.size(); ++i) products_[i] *= factor(i, ratio, repeat);
  }
  double mean() const {
    double sum = 0.0;
    for (const double product : products_) sum += product;
    return sum / static_cast<double>(products_.size());
  }
  /// Probability that a partner with a `part` of the landmark's ratio is the landmark.
  double share_of(double part, double ratio, double repeat) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < products_.size(); ++i) {
      sum += products_[i] * kFractions[i] * repeat * part / factor(i, ratio, repeat);
    }
    return sum / (mean() * static_cast<double>(products_.size()));
  }

 private:
  static double factor(std::size_t i, double ratio, double repeat) {
    return 1.0 + kFractions[i] * repeat * (ratio - 1.0);
  }

  std::array<double, kFractions.size()> products_;
};

PlaceLikelihood::ScanView::ScanView(const std::vector<ScanObservation>& observations,
                                    const FieldOfView& field)
    : range_m_(field.range_m()),
      half_(static_cast<int>(std::ceil(range_m_ / kViewCell_m))),
      targets_(targets_of(observations)) {
  const geometry::OcclusionTest occlusion = occlusion_by(observations);
  for (int y = -half_; y <= half_; ++y) {
    for (int x = -half_; x <= half_; ++x) {
      const Eigen::Vector2d p_base(kViewCell_m * x, kViewCell_m * y);
      const bool in_view = field.covers(p_base) && !occlusion.occludes(p_base);
      nearest_m_.push_back(in_view ? distance_m(observations, p_base) : -1.0F);
    }
  }
}

double PlaceLikelihood::ScanView::nearest_m(const Eigen::Vector2d& p_base) const {
  const int x = static_cast<int>(std::lround(p_base.x() / kViewCell_m));
  const int y = static_cast<int>(std::lround(p_base.y() / kViewCell_m));
  if (std::max(std::abs(x), std::abs(y)) > half_) return -1.0;
  return nearest_m_[static_cast<std::size_t>((y + half_) * (2 * half_ + 1) + x + half_)];
}

PlaceLikelihood::PlaceLikelihood(const PriorMap& map)
    : map_(map),
      place_sd_m_(kPlaceSpacings * map.spacing_m()),
      reach_m_(map.spacing_m()),
      grid_(2.0 * reach_m_) {
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(map.size()); ++i) {
    grid_.insert(i, map[i].p_map);
  }
}

double PlaceLikelihood::place_sd_rad() const { return kPlaceSd_rad; }

bool PlaceLikelihood::are_near(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const {
  const Eigen::Vector3d d = pose_difference(a, b);
  return d.head<2>().norm() < 2.0 * place_sd_m_ && std::abs(d.z()) < 4.0 * kPlaceSd_rad;
}

std::vector<PlaceLikelihood::Target> PlaceLikelihood::targets_of(
    const std::vector<ScanObservation>& observations) {
  // derived: the disc's area.
  constexpr double kAround_m2 = geometry::kPi * kClutter_m * kClutter_m;
  std::vector<Target> targets;
  for (const ScanObservation& s : observations) {
    const auto num_around = std::count_if(
        observations.begin(), observations.end(),
        [&](const auto& other) { return (other.p_base - s.p_base).norm() < kClutter_m; });
    targets.push_back({s.p_base, square(PriorMapConfig::kLandmarkSd_m) + 0.5 * s.covariance.trace(),
                       static_cast<double>(num_around) / kAround_m2});
  }
  return targets;
}

/// Appends the landmarks that the observation may be, if base is at the place; `arm_m`: from there
/// to it, in the axes of map.
void PlaceLikelihood::find_partners(const WeighedPlace& place, const Eigen::Vector2d& arm_m,
                                    const Target& target, std::vector<Partner>& partners) const {
  // Where the place tells no trunk from the next, it learns nothing from one. That holds for most
  // trunks of most places at a start, so no matrix is made to see it.
  const Eigen::Matrix3d& P = place.covariance;
  const double trace_m2 = P(0, 0) + P(1, 1) + P(2, 2) * arm_m.squaredNorm() +
                          2.0 * (arm_m.x() * P(1, 2) - arm_m.y() * P(0, 2));
  if (0.5 * trace_m2 > square(2.0 * place_sd_m_)) return;
  const Eigen::Vector2d p_map = place.T_map_base.head<2>() + arm_m;
  const Eigen::Matrix<double, 2, 3> H = geometry::point_jacobian(arm_m);
  const Eigen::Matrix2d C = H * P * H.transpose();
  grid_.near(p_map.x(), p_map.y(), reach_m_, [&](std::int32_t i) {
    const Eigen::Vector2d offset_m = map_[i].p_map - p_map;
    if (offset_m.squaredNorm() > square(reach_m_)) return;
    const double variance_m2 = target.variance_m2 + square(map_[i].sd_m);
    const Eigen::Matrix2d S = C + variance_m2 * Eigen::Matrix2d::Identity();
    const double d2 = offset_m.dot(S.inverse() * offset_m);
    if (d2 > square(kReachSigmas)) return;
    const double density = std::exp(-0.5 * d2) / (2.0 * geometry::kPi * std::sqrt(S.determinant()));
    partners.push_back({arm_m, offset_m, variance_m2, i, density / target.clutter_per_m2});
  });
}

/// Returns all partners of all observations, sorted by landmark, and counts the observations that
/// have none because the map was not made there.
std::vector<PlaceLikelihood::Partner> PlaceLikelihood::partners_of(
    const WeighedPlace& place, const std::vector<Target>& targets, std::size_t& num_unknown) const {
  std::vector<Partner> partners;
  const Eigen::Matrix2d R_map_base = geometry::rotation(place.T_map_base.z());
  for (const Target& target : targets) {
    const Eigen::Vector2d arm_m = R_map_base * target.p_base;
    const std::size_t num_before = partners.size();
    find_partners(place, arm_m, target, partners);
    num_unknown +=
        partners.size() == num_before && !map_.was_seen(place.T_map_base.head<2>() + arm_m);
  }
  std::stable_sort(partners.begin(), partners.end(),
                   [](const Partner& a, const Partner& b) { return a.landmark < b.landmark; });
  return partners;
}

double PlaceLikelihood::correct(WeighedPlace& place, const ScanView& scan, double share) const {
  std::size_t num_unknown = 0;
  const std::vector<Partner> partners = partners_of(place, scan.targets(), num_unknown);
  std::vector<double> ratios(partners.size(), 0.0);
  SeenAndMissed seen;
  double num_expected = 0.0, num_seen = 0.0;
  for (std::size_t begin = 0, end = 0; begin < partners.size(); begin = end) {
    const std::int32_t landmark = partners[begin].landmark;
    double ratio = 0.0;
    for (; end < partners.size() && partners[end].landmark == landmark; ++end) {
      ratio += partners[end].ratio;
    }
    std::fill(&ratios[begin], &ratios[begin] + (end - begin), ratio);
    seen.add(ratio, map_.repeat(landmark));
    num_expected += map_.repeat(landmark);
  }
  num_expected += add_missed(place, scan, seen);
  Eigen::Matrix3d information = place.covariance.inverse();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < partners.size(); ++i) {
    const Partner& partner = partners[i];
    const double probability =
        seen.share_of(partner.ratio, ratios[i], map_.repeat(partner.landmark));
    num_seen += probability;
    const Eigen::Matrix<double, 2, 3> H = geometry::point_jacobian(partner.arm_m);
    information += share * probability / partner.variance_m2 * H.transpose() * H;
    gradient += share * probability / partner.variance_m2 * H.transpose() * partner.offset_m;
  }
  place.covariance = information.inverse();
  place.covariance = 0.5 * (place.covariance + place.covariance.transpose()).eval();
  place.T_map_base = stepped(place.T_map_base, place.covariance * gradient);
  place.seen += share * (num_seen - place.seen);
  place.expected += share * (num_expected - place.expected);
  const double unknown = static_cast<double>(num_unknown);
  place.known = 1.0 - unknown / std::max(1.0, static_cast<double>(scan.targets().size()));
  return std::log(seen.mean()) + unknown * scan.log_unknown();
}

/// Adds the landmarks in view that no observation is near, and returns how many would be seen.
double PlaceLikelihood::add_missed(const WeighedPlace& place, const ScanView& scan,
                                   SeenAndMissed& seen) const {
  const double place_m2 = 0.5 * place.covariance.topLeftCorner<2, 2>().trace() +
                          2.0 * square(PriorMapConfig::kLandmarkSd_m);
  double num = 0.0;
  map_.near(place.T_map_base.head<2>(), scan.range_m(), [&](std::int32_t i) {
    const Eigen::Vector2d p_base = geometry::inverse_transform(place.T_map_base, map_[i].p_map);
    const double nearest_m = scan.nearest_m(p_base);
    const double around_m2 =
        place_m2 + square(map_[i].sd_m) + 0.5 * place.covariance(2, 2) * p_base.squaredNorm();
    if (nearest_m < 0.0 || square(nearest_m) < square(kReachSigmas) * around_m2) return;
    seen.add(0.0, map_.repeat(i));
    num += map_.repeat(i);
  });
  return num;
}

}  // namespace orchard::pose
