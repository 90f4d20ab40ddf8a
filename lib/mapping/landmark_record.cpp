// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/landmark_record.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::mapping {
namespace {

using detection::Label;

constexpr double kLogOddsMax = 30.0;

void merge_anchors(LandmarkRecord& into, const LandmarkRecord& from) {
  const double total = into.anchor_information + from.anchor_information;
  const double share = from.anchor_information / total;
  const double dx = from.anchor_x_m - into.anchor_x_m;
  const double dy = from.anchor_y_m - into.anchor_y_m;
  into.scatter_m2 = static_cast<float>((1.0 - share) * into.scatter_m2 + share * from.scatter_m2 +
                                       share * (1.0 - share) * 0.5 * (dx * dx + dy * dy));
  into.anchor_x_m += share * dx;
  into.anchor_y_m += share * dy;
  into.anchor_information = static_cast<float>(total);
}

void merge_widths(LandmarkRecord& into, const LandmarkRecord& from) {
  into.width_m = (into.width_m * into.width_information + from.width_m * from.width_information) /
                 (into.width_information + from.width_information);
  into.width_information += from.width_information;
}

void take_statistics(LandmarkRecord& into, const LandmarkRecord& from) {
  into.mean_x_m = from.mean_x_m;
  into.mean_y_m = from.mean_y_m;
  into.m2_xx = from.m2_xx;
  into.m2_xy = from.m2_xy;
  into.m2_yy = from.m2_yy;
  into.roc_sum = from.roc_sum;
  into.num_observations = from.num_observations;
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
}

}  // namespace

void fuse_anchor(LandmarkRecord& r, const Eigen::Vector2d& p_aligned, double variance_m2) {
  const double information = 1.0 / variance_m2;
  const double total = r.anchor_information + information;
  const double share = information / total;
  const Eigen::Vector2d delta = p_aligned - r.anchor();
  r.scatter_m2 =
      static_cast<float>((1.0 - share) * (r.scatter_m2 + share * 0.5 * delta.squaredNorm()));
  r.anchor_x_m += share * delta.x();
  r.anchor_y_m += share * delta.y();
  r.anchor_information = static_cast<float>(total);
}

void fuse_width(LandmarkRecord& r, double width_m, double width_sd_m) {
  const double information = 1.0 / (width_sd_m * width_sd_m);
  r.width_information += static_cast<float>(information);
  r.width_m += static_cast<float>(information / r.width_information * (width_m - r.width_m));
}

void accumulate(LandmarkRecord& r, const Eigen::Vector2d& p_map, double roc_tree, Label label,
                double evidence) {
  const bool is_seen = label != Label::kUnseen;
  if (is_seen && !r.is_seen) {
    r.is_seen = true;
    r.num_observations = 0;
    r.mean_x_m = r.mean_y_m = r.roc_sum = 0.0;
    r.m2_xx = r.m2_xy = r.m2_yy = 0.0f;
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
  if (!is_seen) return;
  r.log_odds = static_cast<float>(std::clamp(r.log_odds + evidence, -kLogOddsMax, kLogOddsMax));
}

void merge(LandmarkRecord& into, const LandmarkRecord& from) {
  merge_anchors(into, from);
  merge_widths(into, from);
  if (from.is_seen && !into.is_seen) {
    take_statistics(into, from);
  } else if (from.is_seen == into.is_seen) {
    add_statistics(into, from);
  }
  into.log_odds = static_cast<float>(
      std::clamp<double>(into.log_odds + from.log_odds, -kLogOddsMax, kLogOddsMax));
  into.num_all += from.num_all;
  into.last_scan = std::max(into.last_scan, from.last_scan);
}

Eigen::Vector2d standard_error_m(const LandmarkRecord& r) {
  if (r.num_observations < 2) return Eigen::Vector2d::Zero();
  const double n = r.num_observations;
  const double scale = 1.0 / (n * (n - 1.0));
  return {std::sqrt(std::max(0.0, scale * r.m2_xx)), std::sqrt(std::max(0.0, scale * r.m2_yy))};
}

double probability_of_tree(const LandmarkRecord& r) {
  return 1.0 / (1.0 + std::exp(-static_cast<double>(r.log_odds)));
}

Label label_of(const LandmarkRecord& r) {
  if (!r.is_seen) return Label::kUnseen;
  return r.log_odds > 0.0f ? Label::kTree : Label::kObject;
}

}  // namespace orchard::mapping
