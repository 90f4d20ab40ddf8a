// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "laser/splitting/run_fit.hpp"

namespace orchard::laser {

/// Explains a run by one or two circles and a few beams on something thin before, between or
/// behind them, at the places where that explains it best (dynamic programming over the beams).
class BestParts {
 public:
  BestParts(const Beams& beams, RunFitter& fit) : beams_(beams), fit_(fit) {}

  /// The parts in order; none where they do not explain it clearly better than one circle or line,
  /// or nothing explains it. Valid until the next call.
  const std::vector<Run>& operator()(const Run& run);

 private:
  static constexpr std::size_t kMostCircles = 2;

  /// The cheapest way to explain the beams up to a place with so many circles: its last part.
  struct Way {
    double cost;
    std::size_t from;
    bool is_circle;
  };

  Run part(const Run& run, std::size_t from, std::size_t to) const;
  void go_on(std::size_t from, std::size_t to, double cost, bool is_circle);
  void find_ways(const Run& run);
  /// Thin beams that are not nearer than what they touch are half on one thing and half on another.
  void drop_mixed();

  const Beams& beams_;
  RunFitter& fit_;
  std::vector<std::ptrdiff_t> positions_;
  std::array<std::vector<Way>, kMostCircles + 1> ways_;  ///< by circles, then by beams explained
  std::vector<Run> parts_;
};

}  // namespace orchard::laser
