// SPDX-License-Identifier: BSD-3-Clause
#include "laser/splitting/part_evidence.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::laser {
namespace {

using geometry::kPi;

/// Prior probability that what stands somewhere is two touching stems: of a plantation's trees a
/// few in a hundred have a second one.
constexpr double kPairs = 0.02;
/// Standard deviations that a chi2 falls below its mean in 1 of 1000 cases.
constexpr double kRareSigmas = 3.0;

double square(double x) { return x * x; }

}  // namespace

PartEvidence::PartEvidence(const WidthConfig& width, const SegmentationConfig& config,
                           double beam_spacing_m, double span_m, double range_sd_m, int num_beams)
    : width_(width),
      width_sd_m_(std::max(width.sd_m, WidthConfig::kSdFloor_m)),
      width_max_m_(config.width_max_m),
      beam_spacing_m_(beam_spacing_m),
      span_m_(span_m + beam_spacing_m),
      num_beams_(num_beams) {
  // Two touching things stand in any direction from one another, a flat one is turned by any angle:
  // the depth between the middles of the two halves is d = span / 2 x sine of an angle that is
  // uniform over half a turn, of density 2 / (pi span) at 0. Each half's depth is a mean over n / 2
  // beams.
  const double depth_sd_m = 2.0 * range_sd_m / std::sqrt(static_cast<double>(num_beams));
  const double posterior = std::sqrt(2.0 * kPi) * depth_sd_m;
  of_depth_ = std::max(0.0, -2.0 * std::log(posterior * 2.0 / (kPi * span_m_)));
}

double PartEvidence::of_width(double width_m, double width_sd_m) const {
  const double variance_m2 = square(width_sd_m_) + square(width_sd_m);
  const double of_trunks = std::exp(-0.5 * square(width_m - width_.mean_m) / variance_m2) /
                           std::sqrt(2.0 * kPi * variance_m2);
  const double density = 0.5 * of_trunks + 0.5 / width_max_m_;
  // The side between two parts lies between two beams; that of one thing is as well known.
  return -2.0 * std::log(density * beam_spacing_m_);
}

double PartEvidence::of_circle(const CircleFit& circle, const Candidate& part) const {
  const int num_assumed = (part.touches_before ? 1 : 0) + (part.touches_after ? 1 : 0);
  const int num_measured = circle.dof + 3 - num_assumed;
  return circle.chi2 - num_measured +
         of_width(2.0 * circle.radius_m, 2.0 * std::sqrt(circle.covariance[5]));
}

double PartEvidence::of_hidden_trunk(const CircleFit& circle) const {
  // The trunk's width is integrated out: what the beams leave of the prior's spread. One
  // measurement of the fit is the prior.
  const double left = 2.0 * std::sqrt(circle.covariance[5]) / width_sd_m_;
  return circle.chi2 - (circle.dof + 2) - 2.0 * std::log(0.5 * std::min(1.0, left));
}

double PartEvidence::of_line(double chi2) const {
  // Half of the things are trunks, which are round, and of the others half are flat.
  return chi2 - num_beams_ - 2 - 2.0 * std::log(0.25 / width_max_m_ * beam_spacing_m_) + of_depth_;
}

double PartEvidence::of_second_circle() const { return of_depth_ - 2.0 * std::log(kPairs); }

double PartEvidence::least_of_two() const {
  const double alike = 2.0 * of_width(0.5 * span_m_, 0.0);
  const double unlike = of_width(width_.mean_m, 0.0) + of_width(span_m_ - width_.mean_m, 0.0);
  return std::min(alike, unlike) + of_second_circle() - kRareSigmas * std::sqrt(2.0 * num_beams_);
}

}  // namespace orchard::laser
