// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/map_merging.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "mapping/compare/map_comparison.hpp"
#include "mapping/kind.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;
using Number = std::pair<std::int32_t, std::int32_t>;  ///< row, position

/// Number of the earlier row with most known trees of this row; 0 without any.
std::int32_t known_row(const Row& row, const std::map<std::int32_t, Number>& numbers) {
  std::map<std::int32_t, int> votes;
  for (const RowSlot& place : row.places) {
    const auto found = numbers.find(place.landmark_id);
    if (place.landmark_id != 0 && found != numbers.end()) ++votes[found->second.first];
  }
  std::int32_t best = 0;
  int most = 0;
  for (const auto& [number, count] : votes) {
    if (count > most) best = number, most = count;
  }
  return best;
}

/// Reverses a row if the positions of its known trees decrease along it.
void turn_as_known(Row& row, const std::map<std::int32_t, Number>& numbers) {
  int rising = 0;
  std::int32_t last = 0;
  for (const RowSlot& place : row.places) {
    const auto found = numbers.find(place.landmark_id);
    if (place.landmark_id == 0 || found == numbers.end() || found->second.second == 0) continue;
    if (last != 0) rising += found->second.second > last ? 1 : -1;
    last = found->second.second;
  }
  if (rising >= 0) return;
  std::reverse(row.places.begin(), row.places.end());
  for (RowSlot& place : row.places) place.position = -place.position;
}

/// Positions of a row's slots, counted from its known trees; 0 where no number is free.
std::vector<std::int32_t> kept_positions(const Row& row, std::int32_t number,
                                         const std::map<std::int32_t, Number>& numbers,
                                         const std::set<Number>& taken) {
  const std::size_t num = row.places.size();
  std::vector<std::int32_t> positions(num, 0);
  std::vector<std::size_t> known;
  for (std::size_t i = 0; i < num; ++i) {
    const auto found = numbers.find(row.places[i].landmark_id);
    if (row.places[i].landmark_id == 0 || found == numbers.end()) continue;
    if (found->second.first != number || found->second.second == 0) continue;
    positions[i] = found->second.second;
    known.push_back(i);
  }
  for (std::size_t i = 0; i < num; ++i) {
    if (positions[i] != 0) continue;
    const auto after = std::upper_bound(known.begin(), known.end(), i);
    const bool has_after = after != known.end(), has_before = after != known.begin();
    std::int32_t position = 0;
    const auto from = [&](std::size_t k) {
      return positions[k] + (row.places[i].position - row.places[k].position);
    };
    if (has_before) position = from(*(after - 1));
    if (!has_before && has_after) position = from(*after);
    const std::int32_t lowest = has_before ? positions[*(after - 1)] : 0;
    const bool is_between = position > lowest && (!has_after || position < positions[*after]);
    if (is_between && position >= 1 && taken.count({number, position}) == 0) {
      positions[i] = position;
    }
  }
  return positions;
}

}  // namespace

IdTransfer keep_ids(const std::vector<Landmark>& earlier, const MapAlignment& alignment,
                    std::int32_t& next_id, std::vector<Landmark>& landmarks) {
  std::vector<std::int32_t> kept_id(landmarks.size(), 0);
  std::vector<bool> is_found(earlier.size(), false);
  IdTransfer kept;
  const auto keep = [&](std::int32_t of_earlier, std::int32_t of_now) {
    kept_id[static_cast<std::size_t>(of_now)] = earlier[static_cast<std::size_t>(of_earlier)].id;
    is_found[static_cast<std::size_t>(of_earlier)] = true;
    ++kept.num_found;
  };
  const geometry::IndexedPoints then(landmark_positions(earlier)),
      now(landmark_positions(landmarks));
  const geometry::IndexedPoints laid(
      without_local_deformation(then, now, alignment.T_a_b, alignment.pairs));
  const double gate_m = pairing_gate_m(then);
  // Trees: use the pairs of compare_maps(), which recognises a tree planted beside a missing one.
  // Pairs farther apart than gate_m may be moved trees, but are too uncertain.
  ComparisonConfig everywhere;
  everywhere.assume_seen = true;
  for (const MapChange& c :
       compare_maps(earlier, landmarks, DetectionMap(), DetectionMap(), alignment, everywhere)
           .changes) {
    if (c.a >= 0 && c.b >= 0 && c.moved_m <= gate_m) keep(c.a, c.b);
  }
  for (const LandmarkPair& pair : pair_landmarks(then, laid, geometry::Pose2{}, gate_m)) {
    const auto i = static_cast<std::size_t>(pair.a), j = static_cast<std::size_t>(pair.b);
    const bool are_objects = !may_be_tree(earlier[i]) && !may_be_tree(landmarks[j]);
    if (are_objects && !is_found[i] && kept_id[j] == 0) keep(pair.a, pair.b);
  }
  kept.num_gone = static_cast<int>(earlier.size()) - kept.num_found;
  kept.num_new = static_cast<int>(landmarks.size()) - kept.num_found;
  for (const Landmark& l : earlier) next_id = std::max(next_id, l.id + 1);
  for (std::size_t j = 0; j < landmarks.size(); ++j) {
    landmarks[j].id = kept_id[j] != 0 ? kept_id[j] : next_id++;
  }
  std::sort(landmarks.begin(), landmarks.end(),
            [](const Landmark& x, const Landmark& y) { return x.id < y.id; });
  return kept;
}

void keep_numbers(const std::vector<Landmark>& earlier, std::vector<Row> rows,
                  std::vector<Landmark>& landmarks, IdTransfer& kept) {
  std::set<std::int32_t> present;
  for (const Landmark& l : landmarks) present.insert(l.id);
  std::map<std::int32_t, Number> numbers;
  std::set<Number> taken;  ///< of trees that still exist
  std::int32_t next_row = 1;
  for (const Landmark& l : earlier) {
    next_row = std::max(next_row, l.row + 1);
    if (l.row == 0 || present.count(l.id) == 0) continue;
    numbers[l.id] = {l.row, l.position};
    if (l.position != 0) taken.insert({l.row, l.position});
  }
  std::map<std::int32_t, Number> given = numbers;
  for (Row& row : rows) {
    std::int32_t number = known_row(row, numbers);
    const bool is_known = number != 0;
    if (is_known) {
      turn_as_known(row, numbers);
    } else {
      number = next_row++;
    }
    const std::vector<std::int32_t> positions =
        is_known ? kept_positions(row, number, numbers, taken) : std::vector<std::int32_t>();
    for (std::size_t i = 0; i < row.places.size(); ++i) {
      const RowSlot& place = row.places[i];
      const std::int32_t position = is_known ? positions[i] : place.position;
      if (place.landmark_id != 0 && numbers.count(place.landmark_id) == 0) {
        given[place.landmark_id] = {number, position};
        kept.num_without_number += position == 0;
      }
      if (position != 0) taken.insert({number, position});
    }
  }
  for (Landmark& l : landmarks) {
    const auto found = given.find(l.id);
    const Number number = found == given.end() ? Number{0, 0} : found->second;
    l.row = number.first;
    l.position = number.second;
  }
}

namespace {

using detection::Label;
using Eigen::Matrix2d;

/// derived: Lower limit of a map's position error [m], regardless of its standard errors.
constexpr double kFloor_m = 0.01;
/// derived: Scatter of one observation [m], for maps from outside without standard errors:
/// that of a detection at some metres.
constexpr double kOneObservation_m = 0.03;

/// Inverse of eq. 13: sum of squares about the mean from the standard error.
double sum_of_squares(double se_m, int n) { return se_m * se_m * n * (n - 1.0); }

double pooled_se(double se_a, int n_a, double se_b, int n_b, double difference_m) {
  const double n = static_cast<double>(n_a) + n_b;
  if (n < 2.0) return 0.0;
  const double sum = sum_of_squares(se_a, n_a) + sum_of_squares(se_b, n_b) +
                     (n_a > 0 && n_b > 0 ? difference_m * difference_m * n_a * n_b / n : 0.0);
  return std::sqrt(sum / (n * (n - 1.0)));
}

/// Position covariance: as stored in the map, else from the standard errors.
Matrix2d covariance_of(const Landmark& l) {
  Matrix2d c;
  c << l.covariance[0], l.covariance[1], l.covariance[1], l.covariance[2];
  if (!(c.determinant() > 0.0)) {
    const double one_m = kOneObservation_m / std::sqrt(std::max(1, l.num_observations));
    const double x_m = l.se_x_m > 0.0 ? l.se_x_m : one_m, y_m = l.se_y_m > 0.0 ? l.se_y_m : one_m;
    c << x_m * x_m, 0.0, 0.0, y_m * y_m;
  }
  return c + Matrix2d::Identity() * kFloor_m * kFloor_m;
}

double log_odds(double probability) {
  const double p = std::clamp(probability, 1e-4, 1.0 - 1e-4);  // files have four digits
  return std::log(p / (1.0 - p));
}

}  // namespace

Landmark transformed(const Landmark& b, const geometry::Pose2& T_a_b) {
  Landmark l = b;
  const Matrix2d R = rotation(T_a_b);
  const Vector2d p = transform(T_a_b, {b.x_m, b.y_m});
  l.x_m = p.x();
  l.y_m = p.y();
  Matrix2d errors = Matrix2d::Zero();
  errors(0, 0) = b.se_x_m * b.se_x_m;
  errors(1, 1) = b.se_y_m * b.se_y_m;
  errors = R * errors * R.transpose();
  l.se_x_m = std::sqrt(errors(0, 0));
  l.se_y_m = std::sqrt(errors(1, 1));
  Matrix2d c;
  c << b.covariance[0], b.covariance[1], b.covariance[1], b.covariance[2];
  c = R * c * R.transpose();
  l.covariance = {c(0, 0), c(0, 1), c(1, 1)};
  return l;
}

namespace {

/// The width of both together. Where one is unknown it is that of the other, unless that is foliage
/// and both are a trunk.
void set_merged_width(const Landmark& a, const Landmark& b, Landmark& merged) {
  if (!(a.width_m > 0.0) || !(b.width_m > 0.0)) {
    const Landmark& known = a.width_m > 0.0 ? a : b;
    const bool is_foliage = known.label == Label::kObject && merged.label == Label::kTree;
    merged.width_m = is_foliage ? 0.0 : known.width_m;
    merged.width_sd_m = is_foliage ? 0.0 : known.width_sd_m;
    return;
  }
  double weight_a = std::max(1, a.num_observations), weight_b = std::max(1, b.num_observations);
  merged.width_sd_m = 0.0;
  if (a.width_sd_m > 0.0 && b.width_sd_m > 0.0) {
    weight_a = 1.0 / (a.width_sd_m * a.width_sd_m);
    weight_b = 1.0 / (b.width_sd_m * b.width_sd_m);
    merged.width_sd_m = 1.0 / std::sqrt(weight_a + weight_b);
  }
  merged.width_m = (weight_a * a.width_m + weight_b * b.width_m) / (weight_a + weight_b);
}

}  // namespace

std::vector<Landmark> raised(std::vector<Landmark> landmarks,
                             const std::optional<double>& raise_m) {
  for (Landmark& l : landmarks) {
    if (!raise_m) l.z_sd_m = 0.0;
    l.z_m = l.z_sd_m > 0.0 ? l.z_m + *raise_m : 0.0;
  }
  return landmarks;
}

Landmark merged_landmark(const Landmark& a, const Landmark& b) {
  Landmark l = a;
  if (a.z_sd_m > 0.0 && b.z_sd_m > 0.0) {
    const double of_a = 1.0 / (a.z_sd_m * a.z_sd_m), of_b = 1.0 / (b.z_sd_m * b.z_sd_m);
    l.z_m = (of_a * a.z_m + of_b * b.z_m) / (of_a + of_b);
    l.z_sd_m = 1.0 / std::sqrt(of_a + of_b);
  } else if (b.z_sd_m > 0.0) {
    l.z_m = b.z_m, l.z_sd_m = b.z_sd_m;
  }
  const int n_a = a.num_observations, n_b = b.num_observations;
  const double n = static_cast<double>(n_a) + n_b;
  l.num_observations = n_a + n_b;
  if (n > 0.0) l.roc_mean = (n_a * a.roc_mean + n_b * b.roc_mean) / n;
  l.se_x_m = pooled_se(a.se_x_m, n_a, b.se_x_m, n_b, b.x_m - a.x_m);
  l.se_y_m = pooled_se(a.se_y_m, n_a, b.se_y_m, n_b, b.y_m - a.y_m);
  const Matrix2d information_a = covariance_of(a).inverse();
  const Matrix2d information_b = covariance_of(b).inverse();
  const Matrix2d covariance = (information_a + information_b).inverse();
  const Vector2d p = covariance * (information_a * Vector2d(a.x_m, a.y_m) +
                                   information_b * Vector2d(b.x_m, b.y_m));
  l.x_m = p.x();
  l.y_m = p.y();
  l.covariance = {covariance(0, 0), covariance(0, 1), covariance(1, 1)};
  if (a.label == Label::kUnseen || b.label == Label::kUnseen) {
    const Landmark& judged = a.label == Label::kUnseen ? b : a;
    l.label = judged.label;
    l.probability = judged.probability;
  } else {
    const double odds = log_odds(a.probability) + log_odds(b.probability);
    l.probability = 1.0 / (1.0 + std::exp(-odds));
    if (a.label != b.label) l.label = odds > 0.0 ? Label::kTree : Label::kObject;
  }
  set_merged_width(a, b, l);
  return l;
}

std::vector<MergedId> merge_into(MergedMap& merged, const std::vector<Landmark>& b,
                                 const MapAlignment& alignment) {
  for (const Landmark& l : merged.landmarks) merged.next_id = std::max(merged.next_id, l.id + 1);
  const geometry::IndexedPoints a_points(landmark_positions(merged.landmarks)),
      b_points(landmark_positions(b));
  // Pair after local alignment, so that deformation does not duplicate a tree.
  const geometry::IndexedPoints b_in_a(
      without_local_deformation(a_points, b_points, alignment.T_a_b, alignment.pairs));
  const double gate_m = pairing_gate_m(a_points);
  std::vector<std::int32_t> partner(b.size(), -1);
  for (const LandmarkPair& pair : pair_landmarks(a_points, b_in_a, geometry::Pose2{}, gate_m)) {
    partner[static_cast<std::size_t>(pair.b)] = pair.a;
  }
  std::vector<std::size_t> order(b.size());
  for (std::size_t j = 0; j < order.size(); ++j) order[j] = j;
  std::sort(order.begin(), order.end(),
            [&](std::size_t x, std::size_t y) { return b[x].id < b[y].id; });
  std::vector<MergedId> ids(b.size());
  for (const std::size_t j : order) {
    Landmark l = transformed(b[j], alignment.T_a_b);
    l.x_m = b_in_a[j].x();
    l.y_m = b_in_a[j].y();
    if (partner[j] >= 0) {
      Landmark& known = merged.landmarks[static_cast<std::size_t>(partner[j])];
      known = merged_landmark(known, l);
      ids[j] = {b[j].id, known.id};
    } else {
      l.id = merged.next_id++;
      l.row = l.position = 0;
      merged.landmarks.push_back(l);
      ids[j] = {b[j].id, l.id};
    }
  }
  return ids;
}

}  // namespace orchard::mapping
