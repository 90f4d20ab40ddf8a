// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/map_alignment.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/rigid_fit2.hpp"
#include "mapping/compare/alignment_candidates.hpp"

namespace orchard::evaluation {
namespace {

constexpr std::size_t kNumStarts = 5;  ///< number of best candidates to refine

struct Fit {
  geometry::Pose2 T_truth_map;
  int num_pairs = 0;
  double sum_m2 = 0.0;

  bool better_than(const Fit& other) const {
    return num_pairs != other.num_pairs ? num_pairs > other.num_pairs : sum_m2 < other.sum_m2;
  }
};

double distance_m(const Point& a, const Point& b) {
  return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m);
}

Point middle_of(const std::vector<Point>& points) {
  Point middle;
  for (const Point& p : points) {
    middle.x_m += p.x_m / static_cast<double>(points.size());
    middle.y_m += p.y_m / static_cast<double>(points.size());
  }
  return middle;
}

geometry::IndexedPoints indexed(const std::vector<Point>& points) {
  std::vector<Eigen::Vector2d> places;
  for (const Point& p : points) places.push_back(p);
  return geometry::IndexedPoints(std::move(places));
}

class Aligner {
 public:
  Aligner(const std::vector<Point>& truth, std::vector<Point> found, double gate_m)
      : truth_(truth), found_(std::move(found)), gate_m_(gate_m), middle_(middle_of(found_)) {
    std::stable_sort(found_.begin(), found_.end(), [&](const Point& a, const Point& b) {
      return distance_m(a, middle_) < distance_m(b, middle_);
    });
  }

  /// Alignments in which most points pair, those with most first.
  std::vector<geometry::Pose2> candidates(const AlignmentSearch& search) const {
    const std::vector<double> alike(std::max(truth_.size(), found_.size()), 0.1);
    const mapping::AlignmentSearch limits{false, search.offset_max_m, search.turn_max_rad,
                                          std::max(gate_m_, 0.5)};
    const mapping::AlignmentCandidates all =
        mapping::alignment_candidates(indexed(truth_), alike, indexed(found_), alike, limits);
    std::vector<geometry::Pose2> starts;
    for (const mapping::AlignmentCandidate& c : all.candidates) {
      if (starts.size() < kNumStarts) starts.push_back(c.T_a_b);
    }
    return starts;
  }

  Fit refine(const geometry::Pose2& start) const {
    Fit fit{start};
    // From the centre outwards: a small error of rotation is a large error of position far away.
    for (std::size_t num = std::min<std::size_t>(found_.size(), 50);;
         num = std::min(found_.size(), 2 * num)) {
      for (const double gate_m : {std::max(gate_m_, 1.0), std::max(gate_m_, 0.5)}) {
        for (int turn = 0; turn < 10; ++turn) {
          const int before = fit.num_pairs;
          const double sum_before_m2 = fit.sum_m2;
          fit = improved(fit.T_truth_map, num, gate_m);
          if (fit.num_pairs == before && std::abs(fit.sum_m2 - sum_before_m2) < 1e-9) break;
        }
      }
      if (num == found_.size()) break;
    }
    for (int turn = 0; turn < 10; ++turn) {
      const Fit next = improved(fit.T_truth_map, found_.size(), gate_m_);
      const bool settled =
          next.num_pairs == fit.num_pairs && std::abs(next.sum_m2 - fit.sum_m2) < 1e-12;
      fit = next;
      if (settled) break;
    }
    return fit;
  }

 private:
  /// The least-squares fit to the pairs of a motion, and the score of that motion.
  Fit improved(const geometry::Pose2& motion, std::size_t num_found, double gate_m) const {
    std::vector<Point> moved;
    for (std::size_t i = 0; i < num_found; ++i) moved.push_back(transform(motion, found_[i]));
    const Assignment assignment = assign(truth_, moved, gate_m);
    Fit fit{motion};
    std::vector<Eigen::Vector2d> from, to;
    for (std::size_t i = 0; i < assignment.size(); ++i) {
      if (assignment[i] == kUnmatched) continue;
      const auto found = static_cast<std::size_t>(assignment[i]);
      from.push_back(found_[found]);
      to.push_back(truth_[i]);
      fit.sum_m2 += std::pow(distance_m(moved[found], truth_[i]), 2);
    }
    fit.num_pairs = static_cast<int>(from.size());
    if (from.size() >= 2) fit.T_truth_map = geometry::fit_rigid(to, from).T_a_b;
    return fit;
  }

  const std::vector<Point>& truth_;
  std::vector<Point> found_;  ///< sorted by distance from their centre
  double gate_m_;
  Point middle_;
};

}  // namespace

std::optional<geometry::Pose2> align_points(const std::vector<Point>& truth,
                                            const std::vector<Point>& found, double gate_m,
                                            const AlignmentSearch& search,
                                            const std::optional<geometry::Pose2>& guess) {
  if (truth.empty() || found.empty()) return std::nullopt;
  const Aligner aligner(truth, found, gate_m);
  std::vector<geometry::Pose2> starts{geometry::Pose2{}};
  if (guess) starts.push_back(*guess);
  for (const geometry::Pose2& motion : aligner.candidates(search)) starts.push_back(motion);
  Fit best;
  for (const geometry::Pose2& start : starts) {
    const Fit fit = aligner.refine(start);
    if (fit.better_than(best)) best = fit;
  }
  if (best.num_pairs < 2) return std::nullopt;
  return best.T_truth_map;
}

}  // namespace orchard::evaluation
