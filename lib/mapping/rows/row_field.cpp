// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/row_field.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/angles.hpp"
#include "geometry/point_grid.hpp"
#include "geometry/statistics.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

/// Distance within which links determine the direction and the spacing at a point, in spacings.
constexpr double kLinkReach_spacings = 4.5;
/// Rounds of reweighting.
constexpr int kFitRounds = 4;

struct Link {
  Vector2d middle{0, 0};
  double length_m = 0.0;
  double angle_rad = 0.0;
  double weight = 0.0;
};

std::vector<Link> links_of(const std::vector<Vector2d>& p_map,
                           const std::vector<RowChain>& chains) {
  std::vector<Link> links;
  for (const RowChain& chain : chains) {
    for (std::size_t k = 1; k < chain.size(); ++k) {
      const Vector2d &a = p_map[index_of(chain[k - 1])], &b = p_map[index_of(chain[k])];
      const Vector2d d = b - a;
      links.push_back({0.5 * (a + b), d.norm(), std::atan2(d.y(), d.x())});
    }
  }
  return links;
}

/// Direction at p [rad]: the value at p of a linear function of position, by iteratively reweighted
/// least squares (Cauchy) about `first_rad`.
double direction_at(const Vector2d& p, const std::vector<Link>& links,
                    const std::vector<std::int32_t>& near, double reach_m, double first_rad) {
  double angle_rad = first_rad;
  double scale_rad = 0.5;  // as far as a first guess may be off
  Eigen::Vector3d fit(0.0, 0.0, 0.0);
  for (int round = 0; round < kFitRounds; ++round) {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    std::vector<double> offs_rad;
    for (const std::int32_t k : near) {
      const Link& link = links[index_of(k)];
      const Vector2d d = (link.middle - p) / reach_m;
      const Eigen::Vector3d row(1.0, d.x(), d.y());
      const double value = geometry::wrap_angle_rad(link.angle_rad - first_rad);
      const double off = value - row.dot(fit);
      offs_rad.push_back(std::abs(off));
      const double weight = link.weight / (1.0 + geometry::square(off / scale_rad));
      information += weight * row * row.transpose();
      right += weight * value * row;
    }
    // Links of one row alone do not tell how directions change across it.
    const double sum = information(0, 0);
    information.diagonal() += sum * Eigen::Vector3d(1e-6, 1e-3, 1e-3);
    if (sum <= 0.0) return angle_rad;
    fit = information.ldlt().solve(right);
    angle_rad = first_rad + fit(0);
    scale_rad = std::clamp(geometry::median(std::move(offs_rad)), 0.02, 0.5);
  }
  return angle_rad;
}

/// Spacing from lengths of links: the median of the single steps. Links count by their length, so
/// that a hedge or a bush of many short ones does not outvote the rows.
double spacing_of(std::vector<double> lengths_m) {
  std::sort(lengths_m.begin(), lengths_m.end());
  const auto quantile = [&](std::size_t begin, std::size_t end, double fraction) {
    double sum_m = 0.0, upto_m = 0.0;
    for (std::size_t k = begin; k < end; ++k) sum_m += lengths_m[k];
    for (std::size_t k = begin; k < end; ++k) {
      upto_m += lengths_m[k];
      if (upto_m >= fraction * sum_m) return k;
    }
    return end - 1;
  };
  // Gaps only make steps longer, so a step from the lower third is single.
  const double typical_m = lengths_m[quantile(0, lengths_m.size(), 0.3)];
  std::size_t begin = 0, end = lengths_m.size();
  while (lengths_m[begin] < typical_m / 1.45) ++begin;
  while (lengths_m[end - 1] > 1.45 * typical_m) --end;
  return lengths_m[quantile(begin, end, 0.5)];
}

}  // namespace

std::vector<LocalRows> local_rows(const std::vector<Vector2d>& p_map, double seeds_spacing_m,
                                  const std::vector<RowChain>& chains) {
  std::vector<Link> links = links_of(p_map, chains);
  std::vector<Vector2d> middles;
  std::vector<double> lengths_m;
  for (const Link& link : links) {
    middles.push_back(link.middle);
    lengths_m.push_back(link.length_m);
  }
  if (links.empty()) return {p_map.size(), {Vector2d::UnitX(), seeds_spacing_m}};
  std::vector<LocalRows> local;
  const double spacing_m = spacing_of(lengths_m);
  // A longer link tells the direction better, but not one over a gap: it may lead to another row.
  for (Link& link : links) {
    const double spacings = link.length_m / spacing_m;
    link.weight = spacings < 1.0 ? geometry::square(spacings) : 1.0 / spacings;
  }
  const double reach_m = kLinkReach_spacings * spacing_m;
  Vector2d overall(0.0, 0.0);
  for (const Link& link : links) {
    overall += link.length_m * Vector2d(std::cos(link.angle_rad), std::sin(link.angle_rad));
  }
  overall.normalize();
  const geometry::IndexedPoints points(std::move(middles));
  for (std::size_t i = 0; i < p_map.size(); ++i) {
    const std::vector<std::int32_t> near = points.within(p_map[i], reach_m);
    if (near.empty()) {
      local.push_back({overall, spacing_m});
      continue;
    }
    // First guess: the mean axis of the links around, by length.
    Vector2d doubled(0.0, 0.0);
    for (const std::int32_t k : near) {
      const Link& link = links[index_of(k)];
      doubled +=
          link.weight * Vector2d(std::cos(2.0 * link.angle_rad), std::sin(2.0 * link.angle_rad));
    }
    double first_rad = 0.5 * std::atan2(doubled.y(), doubled.x());
    Vector2d ahead(0.0, 0.0);
    for (const std::int32_t k : near) {
      const Link& link = links[index_of(k)];
      ahead += link.length_m * Vector2d(std::cos(link.angle_rad), std::sin(link.angle_rad));
    }
    if (ahead.dot(Vector2d(std::cos(first_rad), std::sin(first_rad))) < 0.0) {
      first_rad += geometry::kPi;
    }
    const double angle_rad = direction_at(p_map[i], links, near, reach_m, first_rad);
    LocalRows here{{std::cos(angle_rad), std::sin(angle_rad)}, spacing_m};
    std::vector<double> aligned_m;
    for (const std::int32_t k : near) {
      if (std::cos(links[index_of(k)].angle_rad - angle_rad) < kTurnMax_cos) continue;
      aligned_m.push_back(links[index_of(k)].length_m);
    }
    if (!aligned_m.empty()) here.spacing_m = spacing_of(std::move(aligned_m));
    local.push_back(here);
  }
  return local;
}

RowStep row_step(const std::vector<Vector2d>& p_map, const std::vector<LocalRows>& local,
                 std::int32_t from, std::int32_t to) {
  const LocalRows &a = local[index_of(from)], &b = local[index_of(to)];
  const Vector2d u = (a.direction + b.direction).normalized(),
                 d = p_map[index_of(to)] - p_map[index_of(from)];
  RowStep step;
  step.spacing_m = 0.5 * (a.spacing_m + b.spacing_m);
  const double along_m = u.dot(d);
  step.num_slots = static_cast<int>(std::lround(along_m / step.spacing_m));
  step.along_m = along_m - step.num_slots * step.spacing_m;
  step.beside_m = u.x() * d.y() - u.y() * d.x();
  return step;
}

RowRegularity row_regularity(const std::vector<Vector2d>& p_map,
                             const std::vector<LocalRows>& local,
                             const std::vector<RowChain>& chains) {
  std::vector<double> along, beside;
  double num_steps = 2.0, num_single = 1.0;  // as if a next tree and a gap were known before
  for (const RowChain& chain : chains) {
    if (chain.size() < 2) continue;
    ++num_steps;  // to where no tree follows the last one
    for (std::size_t k = 1; k < chain.size(); ++k) {
      const RowStep step = row_step(p_map, local, chain[k - 1], chain[k]);
      if (step.num_slots < 1) continue;
      const double spread_m = step.spacing_m * std::sqrt(step.num_slots);
      along.push_back(std::abs(step.along_m) / spread_m);
      beside.push_back(std::abs(step.beside_m) / spread_m);
      ++num_steps;
      num_single += step.num_slots == 1;
    }
  }
  RowRegularity regularity;
  regularity.along_spacings = geometry::median(std::move(along)) / std::log(2.0);
  regularity.beside_spacings = geometry::median(std::move(beside)) / std::log(2.0);
  regularity.filled = num_single / num_steps;
  return regularity;
}

}  // namespace orchard::mapping
