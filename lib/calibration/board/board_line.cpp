// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/board/board_line.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "geometry/statistics.hpp"

namespace orchard::calibration {
namespace {

struct Beam {
  std::size_t index = 0;
  double range_m = 0.0;
  double bearing_rad = 0.0;
  Eigen::Vector2d point_m;
};
using Beams = std::vector<Beam>;

struct Fit {
  Eigen::Vector2d centre_m;
  Eigen::Vector2d direction;
  double off_m(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d d = p - centre_m;
    return std::abs(d.x() * direction.y() - d.y() * direction.x());
  }
  double along_m(const Eigen::Vector2d& p) const { return direction.dot(p - centre_m); }
};

Fit fit_line(const Beam* first, const Beam* last) {
  Fit fit;
  fit.centre_m.setZero();
  for (const Beam* b = first; b != last; ++b) fit.centre_m += b->point_m;
  fit.centre_m /= static_cast<double>(last - first);
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const Beam* b = first; b != last; ++b) {
    const Eigen::Vector2d d = b->point_m - fit.centre_m;
    scatter += d * d.transpose();
  }
  fit.direction = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(scatter).eigenvectors().col(1);
  if (fit.direction.dot((last - 1)->point_m - first->point_m) < 0.0) fit.direction *= -1.0;
  return fit;
}

class LineFinder {
 public:
  LineFinder(const laser::Scan& scan, const BoardLineSearch& search)
      : scan_(scan), search_(search) {}

  std::vector<BoardLine> find() {
    const std::vector<Beams> runs = split_at_jumps();
    noise_factor_ = estimate_noise(runs);
    std::vector<BoardLine> lines;
    for (const Beams& run : runs) {
      std::vector<std::size_t> cuts{0};
      split(run, 0, run.size(), cuts);
      merge(run, cuts);
      for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        if (auto line = make_line(run, cuts[i], cuts[i + 1])) lines.push_back(std::move(*line));
      }
    }
    return lines;
  }

 private:
  double sd_m(double range_m) const {
    return std::max(5e-4,
                    noise_factor_ * (search_.range_sd_m + search_.range_sd_fraction * range_m));
  }

  std::vector<Beams> split_at_jumps() const {
    std::vector<Beams> runs;
    for (std::size_t i = 0; i < scan_.ranges_m.size(); ++i) {
      if (!scan_.valid(i) || scan_.ranges_m[i] > search_.range_max_m) continue;
      Beam beam;
      beam.index = i;
      beam.range_m = scan_.ranges_m[i];
      beam.bearing_rad = scan_.bearing_rad(static_cast<double>(i));
      beam.point_m =
          beam.range_m * Eigen::Vector2d(std::cos(beam.bearing_rad), std::sin(beam.bearing_rad));
      const bool joins = !runs.empty() && i - runs.back().back().index <= 2 &&
                         std::abs(beam.range_m - runs.back().back().range_m) <
                             0.06 + 0.02 * std::min(beam.range_m, runs.back().back().range_m);
      if (!joins) runs.emplace_back();
      runs.back().push_back(beam);
    }
    return runs;
  }

  /// Ratio of actual to stated beam noise, from second differences of neighbouring ranges.
  double estimate_noise(const std::vector<Beams>& runs) const {
    std::vector<double> fractions;
    for (const Beams& run : runs) {
      for (std::size_t i = 1; i + 1 < run.size(); ++i) {
        const double bend = run[i - 1].range_m - 2.0 * run[i].range_m + run[i + 1].range_m;
        const double stated = search_.range_sd_m + search_.range_sd_fraction * run[i].range_m;
        if (stated > 0.0) fractions.push_back(std::abs(bend) / (0.6745 * std::sqrt(6.0) * stated));
      }
    }
    return std::clamp(geometry::median(std::move(fractions)), 0.02, 1.0);
  }

  double tolerance_m(const Beam& beam) const { return 4.5 * sd_m(beam.range_m) + 1e-3; }

  /// Appends the ends (exclusive) of the straight segments in [first, last).
  void split(const Beams& run, std::size_t first, std::size_t last,
             std::vector<std::size_t>& cuts) const {
    if (last - first >= 4) {
      // Average several beams at each end, so that one noisy beam does not rotate the chord.
      const std::size_t n = std::min<std::size_t>(3, (last - first) / 4 + 1);
      Eigen::Vector2d a = Eigen::Vector2d::Zero(), b = a;
      for (std::size_t i = 0; i < n; ++i) {
        a += run[first + i].point_m;
        b += run[last - 1 - i].point_m;
      }
      Fit chord;
      chord.centre_m = a / static_cast<double>(n);
      chord.direction = (b - a).normalized();
      std::size_t worst = first;
      double worst_m = 0.0;
      for (std::size_t i = first; i < last; ++i) {
        const double off = chord.off_m(run[i].point_m) / tolerance_m(run[i]);
        if (off > worst_m) {
          worst_m = off;
          worst = i;
        }
      }
      if (worst_m > 1.0) {
        const std::size_t cut = std::clamp(worst, first + 1, last - 1);
        split(run, first, cut, cuts);
        split(run, cut, last, cuts);
        return;
      }
    }
    cuts.push_back(last);
  }

  bool straight(const Beams& run, std::size_t first, std::size_t last) const {
    const Fit fit = fit_line(&run[first], &run[first] + (last - first));
    std::size_t num_off = 0;
    double sum = 0.0;
    for (std::size_t i = first; i < last; ++i) {
      const double off = fit.off_m(run[i].point_m) / sd_m(run[i].range_m);
      sum += std::min(off * off, 9.0);
      if (off > 3.5) ++num_off;
    }
    const double n = static_cast<double>(last - first);
    return static_cast<double>(num_off) <= 0.03 * n + 1.0 && sum <= 1.6 * n;
  }

  void merge(const Beams& run, std::vector<std::size_t>& cuts) const {
    for (bool merged = true; merged && cuts.size() > 2;) {
      merged = false;
      for (std::size_t i = 1; i + 1 < cuts.size(); ++i) {
        if (!straight(run, cuts[i - 1], cuts[i + 1])) continue;
        cuts.erase(cuts.begin() + static_cast<std::ptrdiff_t>(i));
        merged = true;
        break;
      }
    }
  }

  std::optional<BoardLine> make_line(const Beams& run, std::size_t first, std::size_t last) const {
    if (last - first < static_cast<std::size_t>(search_.min_beams)) return std::nullopt;
    Beams beams(run.begin() + static_cast<std::ptrdiff_t>(first),
                run.begin() + static_cast<std::ptrdiff_t>(last));
    Fit fit = fit_line(beams.data(), beams.data() + beams.size());
    for (int round = 0; round < 3; ++round) {
      std::vector<double> off;
      for (const Beam& beam : beams) off.push_back(fit.off_m(beam.point_m));
      const double limit_m = std::max(1e-3, 3.0 * geometry::kMadToSd * geometry::median(off));
      Beams kept;
      for (const Beam& beam : beams) {
        if (fit.off_m(beam.point_m) <= limit_m) kept.push_back(beam);
      }
      if (kept.size() < static_cast<std::size_t>(search_.min_beams)) return std::nullopt;
      const bool same = kept.size() == beams.size();
      beams = std::move(kept);
      fit = fit_line(beams.data(), beams.data() + beams.size());
      if (same) break;
    }
    BoardLine line;
    double sum = 0.0, sd_sum = 0.0;
    for (const Beam& beam : beams) {
      line.ranges_m.push_back(beam.range_m);
      line.bearings_rad.push_back(beam.bearing_rad);
      sum += fit.off_m(beam.point_m) * fit.off_m(beam.point_m);
      sd_sum += sd_m(beam.range_m) * sd_m(beam.range_m);
    }
    if (sum > 2.5 * sd_sum) return std::nullopt;  // curved
    const double n = static_cast<double>(beams.size());
    line.rms_m = std::sqrt(sum / n);
    const double from_m = fit.along_m(beams.front().point_m);
    const double to_m = fit.along_m(beams.back().point_m);
    line.direction = fit.direction;
    line.middle_m = fit.centre_m + 0.5 * (from_m + to_m) * fit.direction;
    line.length_m = (to_m - from_m) * n / (n - 1.0);  // half a beam step at each end
    if (line.length_m < search_.length_min_m || line.length_m > search_.length_max_m) {
      return std::nullopt;
    }
    line.start = end_at(beams.front(), -1);
    line.end = end_at(beams.back(), +1);
    return line;
  }

  /// Whether the beam beyond an edge is a mixed pixel, with a range between edge and next surface.
  bool mixed_at(std::ptrdiff_t i, int step, double edge_range_m) const {
    const std::ptrdiff_t next = i + step;
    if (next < 0 || next >= static_cast<std::ptrdiff_t>(scan_.ranges_m.size())) return false;
    if (!scan_.valid(static_cast<std::size_t>(next))) return false;
    const double range_m = scan_.ranges_m[static_cast<std::size_t>(i)];
    const double behind_m = scan_.ranges_m[static_cast<std::size_t>(next)];
    return behind_m - range_m > std::max(0.15, 0.2 * (behind_m - edge_range_m));
  }

  /// Searches outwards from the last beam of a line for the edge: the first larger range.
  LineEnd end_at(const Beam& last, int step) const {
    LineEnd end;
    const auto size = static_cast<std::ptrdiff_t>(scan_.ranges_m.size());
    constexpr std::ptrdiff_t kMixed = 2;  // max number of mixed pixels
    for (std::ptrdiff_t k = 1; k <= kMixed + 1; ++k) {
      const std::ptrdiff_t i = static_cast<std::ptrdiff_t>(last.index) + k * step;
      if (i < 0 || i >= size) return end;
      const double bearing_rad = scan_.bearing_rad(static_cast<double>(i));
      const bool nothing = !scan_.valid(static_cast<std::size_t>(i));
      const double range_m = scan_.ranges_m[static_cast<std::size_t>(i)];
      if (!nothing && range_m < last.range_m - 0.05) return end;  // hidden by a nearer object
      if (nothing || range_m > last.range_m + 0.15) {
        end.seen = true;
        if (!nothing && mixed_at(i, step, last.range_m)) {
          // The spot lies on both surfaces, so the beam is on the edge, not beyond it.
          end.bearing_rad = bearing_rad;
          end.half_gap_rad = 0.5 * std::abs(scan_.bearing_step_rad);
        } else {
          end.bearing_rad = 0.5 * (last.bearing_rad + bearing_rad);
          end.half_gap_rad = 0.5 * std::abs(bearing_rad - last.bearing_rad);
        }
        return end;
      }
    }
    return end;
  }

  const laser::Scan& scan_;
  const BoardLineSearch& search_;
  double noise_factor_ = 1.0;
};

}  // namespace

std::vector<BoardLine> find_board_lines(const laser::Scan& scan, const BoardLineSearch& search) {
  return LineFinder(scan, search).find();
}

}  // namespace orchard::calibration
