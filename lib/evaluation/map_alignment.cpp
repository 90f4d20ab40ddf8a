// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/map_alignment.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/rigid_fit2.hpp"

namespace orchard::evaluation {
namespace {

constexpr std::size_t kVoters = 400;   ///< number of voting points: those nearest to the centre
constexpr double kBin_m = 0.5;         ///< of the votes' offsets
constexpr std::size_t kNumStarts = 5;  ///< number of best votes to refine
constexpr double kTurnError_m = 0.25;  ///< max displacement of a voter by half a step of rotation

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

/// The motion that rotates about a point and then translates.
geometry::Pose2 about(const Point& middle, double yaw_rad, double dx_m, double dy_m) {
  const Point turned = transform(geometry::Pose2{0.0, 0.0, yaw_rad}, middle);
  return {middle.x_m - turned.x_m + dx_m, middle.y_m - turned.y_m + dy_m, yaw_rad};
}

class Aligner {
 public:
  Aligner(const std::vector<Point>& truth, std::vector<Point> found, double gate_m)
      : truth_(truth), found_(std::move(found)), gate_m_(gate_m), middle_(middle_of(found_)) {
    std::stable_sort(found_.begin(), found_.end(), [&](const Point& a, const Point& b) {
      return distance_m(a, middle_) < distance_m(b, middle_);
    });
  }

  std::vector<geometry::Pose2> vote(const AlignmentSearch& search) const {
    const std::size_t num_voters = std::min(kVoters, found_.size());
    const double radius_m = std::max(1.0, distance_m(found_[num_voters - 1], middle_));
    const double step_rad = 2.0 * kTurnError_m / radius_m;
    const int num_steps = static_cast<int>(std::ceil(search.turn_max_rad / step_rad));
    std::vector<Point> reached;
    for (const Point& p : truth_) {
      if (distance_m(p, middle_) <= radius_m + 1.5 * search.offset_max_m) reached.push_back(p);
    }
    const int half = static_cast<int>(std::ceil(search.offset_max_m / kBin_m));
    const int width = 2 * half + 1;
    struct Peak {
      int votes;
      geometry::Pose2 motion;
    };
    std::vector<Peak> peaks;
    std::vector<int> votes;
    for (int step = -num_steps; step <= num_steps; ++step) {
      const double yaw_rad = step * step_rad;
      votes.assign(static_cast<std::size_t>(width) * width, 0);
      const geometry::Pose2 turn = about(middle_, yaw_rad, 0.0, 0.0);
      for (std::size_t i = 0; i < num_voters; ++i) {
        const Point p = transform(turn, found_[i]);
        for (const Point& q : reached) {
          const int column = static_cast<int>(std::floor((q.x_m - p.x_m) / kBin_m + 0.5)) + half;
          const int row = static_cast<int>(std::floor((q.y_m - p.y_m) / kBin_m + 0.5)) + half;
          if (column < 0 || column >= width || row < 0 || row >= width) continue;
          ++votes[static_cast<std::size_t>(row) * width + column];
        }
      }
      const auto best = std::max_element(votes.begin(), votes.end());
      const int at = static_cast<int>(best - votes.begin());
      peaks.push_back({*best, about(middle_, yaw_rad, (at % width - half) * kBin_m,
                                    (at / width - half) * kBin_m)});
    }
    std::stable_sort(peaks.begin(), peaks.end(),
                     [](const Peak& a, const Peak& b) { return a.votes > b.votes; });
    std::vector<geometry::Pose2> starts;
    for (std::size_t i = 0; i < std::min(kNumStarts, peaks.size()); ++i) {
      starts.push_back(peaks[i].motion);
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
  for (const geometry::Pose2& motion : aligner.vote(search)) starts.push_back(motion);
  Fit best;
  for (const geometry::Pose2& start : starts) {
    const Fit fit = aligner.refine(start);
    if (fit.better_than(best)) best = fit;
  }
  if (best.num_pairs < 2) return std::nullopt;
  return best.T_truth_map;
}

}  // namespace orchard::evaluation
