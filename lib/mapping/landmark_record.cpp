// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/landmark_record.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "mapping/tuning.hpp"

namespace orchard::mapping {
namespace {

using detection::Label;

/// derived: Probabilities of single observations are clamped to [this, 1 - this].
constexpr double kProbabilityMin = 0.005;

double logit(double p) { return std::log(p / (1.0 - p)); }

void merge_association_positions(LandmarkRecord& into, const LandmarkRecord& from) {
  const double total = into.association_information + from.association_information;
  const double fraction = from.association_information / total;
  const double dx = from.association_x_m - into.association_x_m;
  const double dy = from.association_y_m - into.association_y_m;
  into.scatter_m2 =
      static_cast<float>((1.0 - fraction) * into.scatter_m2 + fraction * from.scatter_m2 +
                         fraction * (1.0 - fraction) * 0.5 * (dx * dx + dy * dy));
  into.association_x_m += fraction * dx;
  into.association_y_m += fraction * dy;
  into.association_information = static_cast<float>(total);
}

/// physical: bark is rough by as much.
constexpr double kWidthSdMin_m = 0.002;

/// Beam spacing at the object [m]. The two edges of an object are each uniformly distributed within
/// one beam spacing, so the width variance is a sixth of its square.
double beam_m(const detection::Detection& d) { return std::sqrt(6.0) * d.width_sd_m; }

void merge_widths(LandmarkRecord& into, const LandmarkRecord& from) {
  const double between_m = from.width_m - into.width_m;
  into.width_chi2 += static_cast<float>(
      from.width_chi2 +
      between_m * between_m / (1.0 / into.width_information + 1.0 / from.width_information));
  into.width_observations += from.width_observations;
  if (from.last_scan > into.last_scan) {
    into.width_x_base_m = from.width_x_base_m;
    into.width_y_base_m = from.width_y_base_m;
  }
  into.width_m = (into.width_m * into.width_information + from.width_m * from.width_information) /
                 (into.width_information + from.width_information);
  into.width_information += from.width_information;
}

void copy_statistics(LandmarkRecord& into, const LandmarkRecord& from) {
  into.mean_x_m = from.mean_x_m;
  into.mean_y_m = from.mean_y_m;
  into.m2_xx = from.m2_xx;
  into.m2_xy = from.m2_xy;
  into.m2_yy = from.m2_yy;
  into.roc_sum = from.roc_sum;
  into.num_observations = from.num_observations;
  into.log_odds = from.log_odds;
  into.is_seen = from.is_seen;
}

void add_statistics(LandmarkRecord& into, const LandmarkRecord& from) {
  const double n_into = into.num_observations;
  const double n_from = from.num_observations;
  const double x_m = from.mean_x_m - into.mean_x_m;
  const double y_m = from.mean_y_m - into.mean_y_m;
  const double scale = n_into * n_from / (n_into + n_from);
  into.m2_xx += static_cast<float>(from.m2_xx + scale * x_m * x_m);
  into.m2_xy += static_cast<float>(from.m2_xy + scale * x_m * y_m);
  into.m2_yy += static_cast<float>(from.m2_yy + scale * y_m * y_m);
  into.mean_x_m += n_from / (n_into + n_from) * x_m;
  into.mean_y_m += n_from / (n_into + n_from) * y_m;
  into.num_observations += from.num_observations;
  into.roc_sum += from.roc_sum;
  into.log_odds += from.log_odds;
}

}  // namespace

void fuse_association_position(LandmarkRecord& r, const Eigen::Vector2d& p_aligned,
                               double variance_m2) {
  const double information = 1.0 / variance_m2;
  const double total = r.association_information + information;
  const double fraction = information / total;
  const Eigen::Vector2d delta = p_aligned - r.association_position();
  r.scatter_m2 =
      static_cast<float>((1.0 - fraction) * (r.scatter_m2 + fraction * 0.5 * delta.squaredNorm()));
  r.association_x_m += fraction * delta.x();
  r.association_y_m += fraction * delta.y();
  r.association_information = static_cast<float>(total);
}

void fuse_width(LandmarkRecord& r, const detection::Detection& d, int min_beams) {
  const double sd_m = std::max(d.width_sd_m, kWidthSdMin_m);
  double fraction = 1.0;
  if (r.width_observations > 0.0f) {
    const double moved_m =
        std::hypot(d.centre_x_m - r.width_x_base_m, d.centre_y_m - r.width_y_base_m);
    fraction = std::min(1.0, moved_m / std::max(beam_m(d), kWidthSdMin_m));
  }
  // smallest width that is always hit by enough beams at this range, with one to spare
  const double least_m =
      d.num_beams > 0 ? d.width_m - (d.num_beams - min_beams - 1) * beam_m(d) : 0.0;
  const double known_m = r.width_information > 0.0f ? r.width_m : d.width_m;
  if (d.occlusion != 0 || known_m < least_m) {
    fraction = std::min(fraction, tuning::kHint);
  }
  fraction = std::max(fraction, 1e-3 * tuning::kHint);
  const double information = fraction / (sd_m * sd_m);
  const double before_m = r.width_m;
  r.width_information += static_cast<float>(information);
  r.width_m += static_cast<float>(information / r.width_information * (d.width_m - before_m));
  r.width_chi2 += static_cast<float>(information * (d.width_m - before_m) *
                                     (d.width_m - static_cast<double>(r.width_m)));
  r.width_observations += static_cast<float>(fraction);
  r.width_x_base_m = static_cast<float>(d.centre_x_m);
  r.width_y_base_m = static_cast<float>(d.centre_y_m);
}

double width_sd_m(const LandmarkRecord& r) {
  if (!(r.width_information > 0.0f)) return 0.0;
  const double freedom = std::max(1.0, r.width_observations - 1.0);
  return std::sqrt(std::max(1.0, r.width_chi2 / freedom) / r.width_information);
}

void accumulate(LandmarkRecord& r, const Eigen::Vector2d& p_map, double roc_tree, Label label,
                double evidence, double log_odds_max) {
  const bool is_seen = label != Label::kUnseen;
  if (is_seen && !r.is_seen) {
    r.is_seen = true;
    r.num_observations = 0;
    r.mean_x_m = r.mean_y_m = r.roc_sum = 0.0;
    r.m2_xx = r.m2_xy = r.m2_yy = 0.0f;
    r.log_odds = 0.0f;
  }
  if (!is_seen && r.is_seen) return;
  ++r.num_observations;
  const double n = r.num_observations;
  const double dx = p_map.x() - r.mean_x_m;
  const double dy = p_map.y() - r.mean_y_m;
  r.mean_x_m += dx / n;
  r.mean_y_m += dy / n;
  r.m2_xx += static_cast<float>(dx * (p_map.x() - r.mean_x_m));
  r.m2_xy += static_cast<float>(dx * (p_map.y() - r.mean_y_m));
  r.m2_yy += static_cast<float>(dy * (p_map.y() - r.mean_y_m));
  r.roc_sum += roc_tree;
  r.log_odds = static_cast<float>(std::clamp(r.log_odds + evidence, -log_odds_max, log_odds_max));
}

void merge(LandmarkRecord& into, const LandmarkRecord& from, double log_odds_max) {
  merge_association_positions(into, from);
  merge_widths(into, from);
  if (from.is_seen && !into.is_seen) {
    copy_statistics(into, from);
  } else if (from.is_seen == into.is_seen) {
    add_statistics(into, from);
  }
  into.log_odds =
      static_cast<float>(std::clamp<double>(into.log_odds, -log_odds_max, log_odds_max));
  into.num_all += from.num_all;
  into.clearance = std::max(into.clearance, from.clearance);
  into.is_clump = into.is_clump || from.is_clump;
  into.last_scan = std::max(into.last_scan, from.last_scan);
  into.existence_log_odds = std::max(into.existence_log_odds, from.existence_log_odds);
}

Eigen::Vector2d standard_error_m(const LandmarkRecord& r) {
  if (r.num_observations < 2) return Eigen::Vector2d::Zero();
  const double n = r.num_observations;
  const double scale = 1.0 / (n * (n - 1.0));
  // Shalal et al. 2013, eq. 13: s / sqrt(N), with N - 1 in s.
  return {std::sqrt(std::max(0.0, scale * r.m2_xx)), std::sqrt(std::max(0.0, scale * r.m2_yy))};
}

double log_odds_max(const MapperConfig& config) {
  return config.evidence == Evidence::kLabels ? kLogOddsMax : 1e9;
}

TreeRates tree_rates(const MapperConfig& config) {
  if (config.reflector_marks_tree) return {tuning::kFlashRateOfTrees, tuning::kFlashRateOfObjects};
  return {1.0 - tuning::kWrongLabels, tuning::kWrongLabels};
}

double evidence_of(const detection::Detection& observation, const MapperConfig& config) {
  if (config.evidence == Evidence::kProbability) {
    if (observation.probability_tree + observation.probability_object <= 0.0f) return 0.0;
    const double p =
        std::clamp<double>(observation.probability_tree, kProbabilityMin, 1.0 - kProbabilityMin);
    return logit(p) - logit(config.evidence_base_rate);
  }
  const auto [of_tree, of_object] = tree_rates(config);
  switch (observation.label) {
    case Label::kTree:
      return std::log(of_tree / of_object);
    case Label::kObject:
      return std::log((1.0 - of_tree) / (1.0 - of_object));
    case Label::kUnseen:
      break;
  }
  return 0.0;
}

double log_odds_of_tree(double sum, int num_observations, const MapperConfig& config) {
  if (config.evidence == Evidence::kLabels) return sum;
  const double repeats = 1.0 + std::max(0, num_observations - 1) * config.evidence_correlation;
  return std::clamp(logit(config.evidence_prior) + sum / repeats, -kLogOddsMax, kLogOddsMax);
}

double probability_of_tree(const LandmarkRecord& r, const MapperConfig& config) {
  const double most = config.judges_by_width() ? logit(1.0 - tuning::kWrongLabels) : kLogOddsMax;
  const double log_odds = log_odds_of_tree(r.log_odds, r.num_observations, config);
  return 1.0 / (1.0 + std::exp(-std::clamp(log_odds, -most, most)));
}

Label label_of(const LandmarkRecord& r, const MapperConfig& config) {
  if (!r.is_seen) return Label::kUnseen;
  return log_odds_of_tree(r.log_odds, r.num_observations, config) > 0.0 ? Label::kTree
                                                                        : Label::kObject;
}

LandmarkTable::LandmarkTable(std::vector<LandmarkRecord> records) : records_(std::move(records)) {
  for (std::int32_t index = 0; index < num_indices(); ++index) {
    const LandmarkRecord& r = (*this)[index];
    if (r.is_removed) continue;
    grid_.insert(index, r.association_x_m, r.association_y_m);
    ++num_alive_;
  }
}

std::int32_t LandmarkTable::add(const Eigen::Vector2d& p_map, double width_m) {
  if (records_.size() >= static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max() - 1)) {
    throw std::length_error("mapper: more landmarks than ids");
  }
  const std::int32_t index = num_indices();
  LandmarkRecord r;
  r.association_x_m = p_map.x();
  r.association_y_m = p_map.y();
  r.width_m = static_cast<float>(width_m);
  // Grow by a quarter: doubling could leave half of a large map's memory unused.
  if (records_.size() == records_.capacity()) {
    records_.reserve(records_.size() + records_.size() / 4 + 64);
  }
  records_.push_back(r);
  grid_.insert(index, r.association_x_m, r.association_y_m);
  ++num_alive_;
  return index;
}

void LandmarkTable::remove(std::int32_t index) {
  LandmarkRecord& r = records_[static_cast<std::size_t>(index)];
  grid_.remove(index, r.association_x_m, r.association_y_m);
  r = LandmarkRecord{};
  r.is_removed = true;
  --num_alive_;
}

std::size_t LandmarkTable::num_bytes() const {
  return records_.capacity() * sizeof(LandmarkRecord) + grid_.num_bytes();
}

}  // namespace orchard::mapping
