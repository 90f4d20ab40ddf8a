// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "geometry/angles.hpp"
#include "mapping/landmark.hpp"
#include "worlds/landmark.hpp"

namespace orchard::test {

/// A block whose rows and places are known because it was planted by them.
struct Planted {
  std::vector<mapping::Landmark> landmarks;
  std::map<std::int32_t, std::pair<int, int>> numbers;  ///< id -> row, position
  double forward_deg = 0.0;

  int num_rows() const {
    int most = 0;
    for (const auto& [id, number] : numbers) most = std::max(most, number.first);
    return most;
  }
};

struct Plan {
  int num_rows = 8;
  int num_places = 25;
  double row_spacing_m = 4.0;
  double tree_spacing_m = 2.0;
  double unequal = 0.12;  ///< steps differ from the spacing by up to this fraction
  double bend_m = 0.0;    ///< radius of the middle row; 0 = straight
  double heading_rad = 0.3;
  double missing = 0.1;
  double noise_m = 0.03;
  double post_fraction = 0.2;  ///< of the steps have a post halfway
};

inline Planted plant(const Plan& plan, std::mt19937_64& random) {
  const auto uniform = [&](double a, double b) {
    return a + (b - a) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  const auto normal = [&] {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += uniform(0.0, 1.0);
    return sum;
  };
  Planted block;
  block.forward_deg = plan.heading_rad * 180.0 / geometry::kPi;
  int id = 100;
  // along a row as arc length of the middle row, across to the right of it
  const auto place = [&](double along_m, double across_m) {
    double x = along_m, y = -across_m;
    if (plan.bend_m != 0.0) {
      const double angle = along_m / plan.bend_m;
      x = (plan.bend_m + across_m) * std::sin(angle);
      y = plan.bend_m - (plan.bend_m + across_m) * std::cos(angle);
    }
    const double c = std::cos(plan.heading_rad), s = std::sin(plan.heading_rad);
    return std::make_pair(c * x - s * y, s * x + c * y);
  };
  const auto add = [&](double along_m, double across_m, detection::Label label) {
    mapping::Landmark l;
    l.id = ++id;
    l.label = label;
    std::tie(l.x_m, l.y_m) = place(along_m, across_m);
    l.x_m += plan.noise_m * normal();
    l.y_m += plan.noise_m * normal();
    block.landmarks.push_back(l);
    return l.id;
  };
  const double length_m = (plan.num_places - 1) * plan.tree_spacing_m;
  for (int row = 0; row < plan.num_rows; ++row) {
    const double across_m = (row - 0.5 * (plan.num_rows - 1)) * plan.row_spacing_m;
    double along_m = -0.5 * length_m;
    for (int position = 0; position < plan.num_places; ++position) {
      if (uniform(0, 1) >= plan.missing) {
        block.numbers[add(along_m, across_m, detection::Label::kTree)] = {row + 1, position + 1};
      }
      const double step_m = plan.tree_spacing_m * uniform(1.0 - plan.unequal, 1.0 + plan.unequal);
      if (uniform(0, 1) < plan.post_fraction)
        add(along_m + 0.5 * step_m, across_m, detection::Label::kObject);
      along_m += step_m;
    }
  }
  std::shuffle(block.landmarks.begin(), block.landmarks.end(), random);
  return block;
}

inline Plan random_plan(std::mt19937_64& random) {
  const auto uniform = [&](double a, double b) {
    return a + (b - a) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  Plan plan;
  plan.num_rows = 3 + static_cast<int>(uniform(0, 10));
  plan.num_places = 10 + static_cast<int>(uniform(0, 31));
  plan.row_spacing_m = uniform(3.0, 6.0);
  plan.tree_spacing_m = plan.row_spacing_m * uniform(0.25, 0.75);
  plan.heading_rad = uniform(-geometry::kPi, geometry::kPi);
  const double length_m = plan.num_places * plan.tree_spacing_m;
  if (uniform(0, 1) < 0.6) {
    // bent by up to two thirds of a right angle over its length, either way, inner rows included
    const double turn_rad = uniform(0.1, 1.05);
    const double radius_m = length_m / turn_rad + plan.num_rows * plan.row_spacing_m;
    plan.bend_m = uniform(0, 1) < 0.5 ? radius_m : -radius_m;
  }
  return plan;
}

/// A random block, straight or curved, as a rig without a camera maps it: posts, bushes at the ends
/// of the rows, a hedge across them and one beside them pass for trees.
inline Planted plant_amid_clutter(std::mt19937_64& random) {
  const auto uniform = [&](double a, double b) {
    return a + (b - a) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  Plan plan = random_plan(random);
  plan.num_places = 8 + static_cast<int>(uniform(0, 10));
  plan.unequal = uniform(0.0, 0.08);
  plan.noise_m = uniform(0.03, 0.1);
  plan.post_fraction = 0.05;
  Planted block = plant(plan, random);
  std::map<int, std::map<int, Eigen::Vector2d>> rows;
  for (mapping::Landmark& l : block.landmarks) {
    const auto planted = block.numbers.find(l.id);
    if (planted != block.numbers.end()) {
      rows[planted->second.first][planted->second.second] = {l.x_m, l.y_m};
    }
    l.probability = 1.0;
    l.roc_mean = planted != block.numbers.end() ? uniform(0.6, 0.9) : uniform(0.2, 0.5);
    l.num_observations = static_cast<int>(uniform(10, 60));
    l.label = detection::Label::kTree;
  }
  int id = 20000;
  const auto add = [&](const Eigen::Vector2d& p) {
    mapping::Landmark l = test::tree(++id, p.x(), p.y());
    l.probability = 1.0;
    l.roc_mean = uniform(0.3, 0.8);
    l.num_observations = static_cast<int>(uniform(5, 40));
    block.landmarks.push_back(l);
  };
  const auto end_of = [&](int row) { return rows[row].rbegin()->second; };
  const auto along_of = [&](int row) {
    const auto last = rows[row].rbegin();
    return Eigen::Vector2d((last->second - std::prev(last)->second).normalized());
  };
  for (const auto& [row, places] : rows) {
    if (places.size() < 2) continue;
    if (uniform(0, 1) < 0.5) {  // a bush at the start
      const int num_parts = 2 + static_cast<int>(uniform(0, 5));
      for (int part = 0; part < num_parts; ++part) {
        add(places.begin()->second + Eigen::Vector2d(uniform(-1.5, 1.5), uniform(-1.5, 1.5)));
      }
    }
  }
  const int first = rows.begin()->first, last = rows.rbegin()->first;
  if (rows[first].size() < 2 || rows[last].size() < 2) return block;
  // A hedge across the ends of the rows.
  const double beyond_m = uniform(0.7, 1.5) * plan.tree_spacing_m;
  for (int row = first; row < last; ++row) {
    if (rows.count(row) == 0 || rows.count(row + 1) == 0) continue;
    if (rows[row].size() < 2 || rows[row + 1].size() < 2) continue;
    const Eigen::Vector2d a = end_of(row) + beyond_m * along_of(row);
    const Eigen::Vector2d d = end_of(row + 1) + beyond_m * along_of(row + 1) - a;
    for (double m = 0.0; m < d.norm(); m += uniform(0.5, 2.0)) {
      add(a + m * d.normalized() + uniform(-0.4, 0.4) * along_of(row));
    }
  }
  // A hedge along the last row, to its right.
  const double beside_m = uniform(0.4, 0.8) * plan.row_spacing_m;
  Eigen::Vector2d before = rows[last].begin()->second;
  for (const auto& [position, p] : rows[last]) {
    const Eigen::Vector2d d = p - before;
    if (d.norm() > 0.0) {
      const Eigen::Vector2d right = Eigen::Vector2d(d.y(), -d.x()).normalized();
      for (double m = uniform(0.0, 1.5); m < d.norm(); m += uniform(0.7, 5.0)) {
        add(before + m * d.normalized() + (beside_m + uniform(-0.3, 0.3)) * right);
      }
    }
    before = p;
  }
  return block;
}

}  // namespace orchard::test
