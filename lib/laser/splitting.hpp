// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "laser/candidates.hpp"
#include "laser/circle_fit.hpp"
#include "laser/laser_config.hpp"

namespace orchard::laser {

/// derived: min number of beams of a part with a circle, which has three parameters.
inline constexpr int kMinPartBeams = 3;

/// The part of a candidate from beam `first` to beam `last`, both on the object.
Candidate part_of(const Beams& beams, const Candidate& candidate, std::ptrdiff_t first,
                  std::ptrdiff_t last);

struct Split {
  Candidate before, after;
};

/// Splits a candidate after the beam at `position`, which lies on the object and is not its last.
Split split_at(const Beams& beams, const Candidate& candidate, std::ptrdiff_t position);

/// For two touching parts at different depths, marks the common side of the farther part as hidden,
/// because it continues behind the nearer one.
void order_by_depth(Candidate& before, Candidate& after, CandidateFitter& fit);

/// Evidence that the beams of one candidate lie on a circle, on two, or on a line, as costs:
/// -2 ln of the probability of the beams with the model's parameters integrated out (Laplace), but
/// for what all models share (the two outer sides and the range). A lower cost is more probable.
///
/// A width is drawn from the trunks (WidthConfig) or, as probable, from anything up to
/// SegmentationConfig::width_max_m. Chi2 is counted as its excess over the number of measurements,
/// so that a beam to which a model gives no weight speaks neither for nor against it.
class PartEvidence {
 public:
  /// `beam_spacing_m` is range x bearing step, `span_m` the distance between the outermost beams.
  PartEvidence(const WidthConfig& width, const SegmentationConfig& config, double beam_spacing_m,
               double span_m, double range_sd_m, int num_beams);

  /// Cost of a circle; `part` says on which of its sides another part touches it.
  double of_circle(const CircleFit& circle, const Candidate& part) const;
  /// Cost of a trunk of which a side is hidden behind the part beside it; `circle` was fitted with
  /// radius_prior().
  double of_hidden_trunk(const CircleFit& circle) const;
  RadiusPrior radius_prior() const { return {0.5 * width_.mean_m, 0.5 * width_sd_m_}; }
  /// Cost of a line; `chi2` is that of line_chi2(), with that of its two visible sides, which it
  /// meets exactly.
  double of_line(double chi2) const;
  /// Cost of a second circle beside the first: its depth, and how seldom two stems touch.
  double of_second_circle() const;
  /// Lower limit of the cost of two circles, however they share the span; noise goes below it in 1
  /// of 1000 candidates.
  double least_of_two() const;

 private:
  double of_width(double width_m, double width_sd_m) const;

  WidthConfig width_;
  double width_sd_m_, width_max_m_, beam_spacing_m_, span_m_, of_depth_;
  int num_beams_;
};

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
  /// derived: more than two stems of one tree are found as two.
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

/// Splits candidates that two circles explain clearly better than one: trunks that touch, side by
/// side or one behind the other, and trunks widened by a few beams of grass or a stake. `width`
/// says how wide trunks are.
void split_touching(const Beams& beams, const SegmentationConfig& config, const WidthConfig& width,
                    const LaserConfig& laser, CandidateFitter& fit,
                    std::vector<Candidate>& candidates);

/// Makes each cluster of bright beams a separate candidate, so that a pole with a reflector is
/// distinguished from objects close to it, even with a single bright beam. The rest of the
/// candidates that a cluster is cut out of remains on both sides. A candidate that contains the
/// whole cluster and for which `is_trunk` is true is not cut: a trunk with a narrower reflector.
void cut_at_bright(const Beams& beams, std::vector<Candidate>& candidates,
                   const std::function<bool(const Candidate&)>& is_trunk);

}  // namespace orchard::laser
