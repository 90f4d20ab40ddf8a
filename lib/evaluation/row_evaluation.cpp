// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/row_evaluation.hpp"

#include <fmt/core.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <utility>

#include "geometry/statistics.hpp"

namespace orchard::evaluation {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Vector2d place_of(const TrackPose& pose) { return {pose.x_m, pose.y_m}; }

Vector2d left_of(const Vector2d& along) { return {-along.y(), along.x()}; }

/// A point beside a row.
struct Beside {
  double distance_m = kInfinity;  ///< from the row, between its ends
  double offset_m = 0.0;          ///< to the left of the row, which goes straight on at its ends
  double beyond_m = 0.0;          ///< how far past the nearer end; 0 between them
  Vector2d along{1.0, 0.0};       ///< direction of the row there
};

/// derived: trees stand some centimetres beside their row's line, so its direction is that of this
/// many steps before and behind.
constexpr std::size_t kDirectionSteps = 2;

Beside beside(const RowLine& row, const Vector2d& p) {
  Beside best;
  for (std::size_t i = 1; i < row.size(); ++i) {
    const Vector2d step = row[i] - row[i - 1];
    if (step.squaredNorm() == 0.0) continue;
    const double on_it = std::clamp(step.dot(p - row[i - 1]) / step.squaredNorm(), 0.0, 1.0);
    const Vector2d from = p - row[i - 1] - on_it * step;
    if (from.norm() >= best.distance_m) continue;
    const Vector2d chord = row[std::min(i + kDirectionSteps, row.size() - 1)] -
                           row[i - 1 - std::min(i - 1, kDirectionSteps)];
    const Vector2d along = (chord.norm() > 0.0 ? chord : step).normalized();
    const bool is_before = i == 1 && on_it == 0.0;
    const bool is_behind = i + 1 == row.size() && on_it == 1.0;
    const double beyond_m = is_before ? -along.dot(from) : is_behind ? along.dot(from) : 0.0;
    best = {from.norm(), left_of(along).dot(from), std::max(0.0, beyond_m), along};
  }
  return best;
}

/// The space between two rows, or beside an outermost one. A row is -1 where there is none.
struct Aisle {
  int left = -1, right = -1;
  Vector2d along{1.0, 0.0};  ///< direction of the nearer row
};

class Rows {
 public:
  explicit Rows(const std::vector<RowLine>& rows) : rows_(rows) {
    for (const RowLine& row : rows) {
      AlignedBox2d box;
      for (const Vector2d& p : row) {
        if (!p.allFinite()) throw std::invalid_argument("evaluate_rows: a place is not finite");
        box.extend(p);
      }
      if (row.size() < 2 || box.sizes().norm() == 0.0) {
        throw std::invalid_argument("evaluate_rows: a row has fewer than two places");
      }
      boxes_.push_back(box);
    }
    if (rows.size() < 2) throw std::invalid_argument("evaluate_rows: fewer than two rows");
    std::vector<double> spacings_m;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Vector2d middle = rows[i][rows[i].size() / 2];
      spacings_m.push_back(nearest(middle, static_cast<int>(i)).second);
    }
    aisle_m_ = geometry::median(std::move(spacings_m));
  }

  double aisle_m() const { return aisle_m_; }

  double distance_m(int row, const Vector2d& p) const { return at(row, p).distance_m; }

  /// The row nearest to a point, and its distance.
  std::pair<int, double> nearest(const Vector2d& p, int except = -1) const {
    std::pair<int, double> best{-1, kInfinity};
    for (int i = 0; i < static_cast<int>(rows_.size()); ++i) {
      if (i == except || box(i).exteriorDistance(p) >= best.second) continue;
      const double distance = distance_m(i, p);
      if (distance < best.second) best = {i, distance};
    }
    return best;
  }

  /// The aisle at a point; none on a headland and away from the rows.
  std::optional<Aisle> aisle_at(const Vector2d& p) const {
    const int nearest_row = nearest(p).first;
    Aisle aisle;
    aisle.along = at(nearest_row, p).along;
    double left_m = kReach * aisle_m_, right_m = left_m;
    bool left_between = false, right_between = false;
    for (int i = 0; i < static_cast<int>(rows_.size()); ++i) {
      if (box(i).exteriorDistance(p) > kReach * aisle_m_) continue;
      const Beside row = at(i, p);
      // Rows of a block end within an aisle's width of each other: beside one end is beside both.
      if (row.beyond_m > aisle_m_) continue;
      const double side_m = row.along.dot(aisle.along) >= 0.0 ? row.offset_m : -row.offset_m;
      // The row is to the right of a point that is to the row's left.
      if (side_m >= 0.0 && side_m < right_m) {
        right_m = side_m;
        aisle.right = i;
        right_between = row.beyond_m == 0.0;
      } else if (side_m < 0.0 && -side_m < left_m) {
        left_m = -side_m;
        aisle.left = i;
        left_between = row.beyond_m == 0.0;
      }
    }
    if (!left_between && !right_between) return std::nullopt;
    const bool is_outside = aisle.left < 0 || aisle.right < 0;
    if (is_outside && std::min(left_m, right_m) > aisle_m_) return std::nullopt;
    return aisle;
  }

  /// Whether a point is on the same side of the aisle's rows as one in the aisle.
  bool is_in(const Aisle& aisle, const Vector2d& in_aisle, const Vector2d& p) const {
    for (const int row : {aisle.left, aisle.right}) {
      if (row < 0) continue;
      const double one_m = at(row, in_aisle).offset_m, other_m = at(row, p).offset_m;
      if ((one_m >= 0.0) != (other_m >= 0.0)) return false;
      const bool is_outside = aisle.left < 0 || aisle.right < 0;
      if (is_outside && std::abs(other_m) > aisle_m_) return false;
    }
    return true;
  }

 private:
  /// derived: as in the navigation graph, rows farther apart than this many aisles have no aisle.
  static constexpr double kReach = 2.5;

  Beside at(int row, const Vector2d& p) const {
    return beside(rows_[static_cast<std::size_t>(row)], p);
  }
  const AlignedBox2d& box(int row) const { return boxes_[static_cast<std::size_t>(row)]; }

  const std::vector<RowLine>& rows_;
  std::vector<AlignedBox2d> boxes_;
  double aisle_m_ = 0.0;
};

}  // namespace

RowEvaluation evaluate_rows(const std::vector<ComparedPose>& compared,
                            const std::vector<RowLine>& lines) {
  const Rows rows(lines);
  RowEvaluation evaluation;
  evaluation.num_rows = static_cast<int>(lines.size());
  evaluation.aisle_m = rows.aisle_m();
  evaluation.num_compared = static_cast<int>(compared.size());
  std::vector<double> across_m, from_row_m, truth_from_row_m;
  const ComparedPose* wrong_since = nullptr;
  bool was_nearest = true;
  for (const ComparedPose& pair : compared) {
    const Vector2d truth = place_of(pair.truth), estimate = place_of(pair.estimate);
    const auto [true_row, true_distance_m] = rows.nearest(truth);
    const bool is_nearest = rows.nearest(estimate).first == true_row;
    evaluation.num_nearest_row += is_nearest ? 1 : 0;
    evaluation.num_row_switches += was_nearest && !is_nearest ? 1 : 0;
    was_nearest = is_nearest;
    truth_from_row_m.push_back(true_distance_m);
    from_row_m.push_back(rows.distance_m(true_row, estimate));

    const std::optional<Aisle> aisle = rows.aisle_at(truth);
    const bool is_right = aisle && rows.is_in(*aisle, truth, estimate);
    if (!aisle || is_right) wrong_since = nullptr;
    if (!aisle) continue;
    ++evaluation.num_in_aisles;
    across_m.push_back(std::abs(left_of(aisle->along).dot(estimate - truth)));
    evaluation.num_right_aisle += is_right ? 1 : 0;
    if (is_right) continue;
    if (wrong_since == nullptr) wrong_since = &pair;
    const double stay_s = 1e-6 * static_cast<double>(pair.utime - wrong_since->utime);
    evaluation.wrong_longest_s = std::max(evaluation.wrong_longest_s, stay_s);
    evaluation.wrong_longest_m =
        std::max(evaluation.wrong_longest_m, pair.way_m - wrong_since->way_m);
  }
  evaluation.cross_track_95_m = geometry::quantile(across_m, 0.95);
  evaluation.cross_track_m = error_statistics(std::move(across_m));
  evaluation.from_row_m = error_statistics(std::move(from_row_m));
  evaluation.truth_from_row_m = error_statistics(std::move(truth_from_row_m));
  return evaluation;
}

namespace {

double share(int part, int all) { return all == 0 ? 0.0 : static_cast<double>(part) / all; }

}  // namespace

std::string row_summary(const RowEvaluation& e) {
  std::string text = fmt::format(
      "rows: {}, {:.2f} m apart; at {} of {} poses the robot is between or beside them\n",
      e.num_rows, e.aisle_m, e.num_in_aisles, e.num_compared);
  if (e.num_in_aisles > 0) {
    text += fmt::format(
        "cross-track error there: RMS {:.3f}, median {:.3f}, 95 % {:.3f}, most {:.3f} m\n"
        "right aisle: {:.1f} % of them; longest in a wrong one: {:.1f} s, {:.1f} m\n",
        e.cross_track_m.rmse, e.cross_track_m.median, e.cross_track_95_m, e.cross_track_m.max,
        100.0 * share(e.num_right_aisle, e.num_in_aisles), e.wrong_longest_s, e.wrong_longest_m);
  }
  return text + fmt::format(
                    "nearest row right: {:.1f} % of all poses, left {} times; distance from it: "
                    "mean {:.3f}, median {:.3f}, most {:.3f} m (of the true path: mean {:.3f} m)\n",
                    100.0 * share(e.num_nearest_row, e.num_compared), e.num_row_switches,
                    e.from_row_m.mean, e.from_row_m.median, e.from_row_m.max,
                    e.truth_from_row_m.mean);
}

std::string row_json(const RowEvaluation& e) {
  const nlohmann::ordered_json json{{"num_rows", e.num_rows},
                                    {"aisle_m", e.aisle_m},
                                    {"num_compared", e.num_compared},
                                    {"num_in_aisles", e.num_in_aisles},
                                    {"cross_track_rms_m", e.cross_track_m.rmse},
                                    {"cross_track_median_m", e.cross_track_m.median},
                                    {"cross_track_95_m", e.cross_track_95_m},
                                    {"cross_track_max_m", e.cross_track_m.max},
                                    {"right_aisle", share(e.num_right_aisle, e.num_in_aisles)},
                                    {"wrong_longest_s", e.wrong_longest_s},
                                    {"wrong_longest_m", e.wrong_longest_m},
                                    {"nearest_row", share(e.num_nearest_row, e.num_compared)},
                                    {"num_row_switches", e.num_row_switches},
                                    {"from_row_mean_m", e.from_row_m.mean},
                                    {"from_row_median_m", e.from_row_m.median},
                                    {"from_row_max_m", e.from_row_m.max},
                                    {"truth_from_row_mean_m", e.truth_from_row_m.mean}};
  return json.dump(2) + "\n";
}

}  // namespace orchard::evaluation
