// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "laser/splitting/candidate_fit.hpp"
#include "laser/splitting/part_evidence.hpp"

namespace orchard::laser {

/// Splits a candidate into one or two circles and a few clutter beams at minimum total cost
/// (dynamic programming over the beams). Clutter may lie before, between or after the circles.
class BestSplit {
 public:
  BestSplit(const Beams& beams, CandidateFitter& fit) : beams_(beams), fit_(fit) {}

  /// The parts in order of bearing; none if a single circle or line explains the candidate as well,
  /// or if nothing does. Valid until the next call.
  const std::vector<Candidate>& operator()(const Candidate& candidate,
                                           const PartEvidence& evidence);

 private:
  static constexpr std::size_t kMaxCircles = 2;

  /// What a part is; a trunk may lie behind the part before or after it.
  enum class Kind { kClutter, kCircle, kBehindBefore, kBehindAfter };

  /// Cheapest explanation of the first beams with a given number of circles: its total cost, and
  /// the first beam and kind of its last part.
  struct Explanation {
    double cost;
    std::size_t from;
    Kind kind;
  };

  Candidate part(const Candidate& candidate, std::size_t from, std::size_t to) const;
  void extend_explanation(std::size_t from, std::size_t to, double cost, Kind kind);
  /// Tries beams as a trunk whose side is hidden behind a nearer neighbour among the candidate's
  /// beams. `near`: where its fit starts.
  void extend_by_hidden_trunk(const Candidate& piece, std::size_t from, std::size_t to,
                              const std::optional<CircleFit>& near, const PartEvidence& evidence);
  /// Tries the beams from `from` on as the first circle, for every end from `least` on; returns
  /// whether one was good.
  bool extend_by_first_circle(const Candidate& candidate, std::size_t from, std::size_t least,
                              const PartEvidence& evidence);
  /// Tries the beams from `from` to an end of the candidate as the last circle.
  void extend_by_last_circle(const Candidate& candidate, std::size_t from, std::size_t least,
                             const PartEvidence& evidence);
  /// Tries beams as a circle; a good one becomes `last`. Returns whether it is good.
  bool extend_by_circle(const Candidate& piece, std::size_t from, std::size_t to,
                        std::optional<CircleFit>& last, const PartEvidence& evidence);
  void find_explanations(const Candidate& candidate, const PartEvidence& evidence);
  /// Drops clutter beams that are not nearer than their neighbours: they are mixed pixels.
  void drop_mixed();

  const Beams& beams_;
  CandidateFitter& fit_;
  std::vector<std::ptrdiff_t> positions_;
  /// By number of circles, then by number of beams explained.
  std::array<std::vector<Explanation>, kMaxCircles + 1> explanations_;
  std::vector<Candidate> parts_;
};

}  // namespace orchard::laser
