// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::pose {

/// Whether another visit finds again what one visit has seen: the one model of localisation in a
/// prior map, of the comparison of two maps and of ids that are kept.
///
/// A trunk is seen at most of its chances, from all sides and on every day. A sucker or a twig is
/// seen at few: another visit drives another line, and a scanner that nods by a degree cuts another
/// part of it. What the chances of one visit tell of those of another is therefore worth few
/// observations, however many there were.

/// Detection rate by `num_seen` of `num_chances` observations (>= 0), half an observation either
/// way added (Jeffreys' prior); within (0, 1).
double detection_rate(double num_seen, double num_chances);

/// Probability that another visit sees at more than `rate_min` of its chances what one visit saw at
/// `rate` of its own (both in [0, 1]). The other visit's rate is Beta(2 rate, 2 (1 - rate)): of the
/// same mean, and as wide as two observations leave it.
double probability_seen_again(double rate, double rate_min);

/// Probability that another visit shows the same one of a clump's parts, of which `num_others` lie
/// near: each shows one at random.
inline double probability_same_part(int num_others) { return 1.0 / (1.0 + num_others); }

/// How near another thing is a part of the same clump, by the usual distance between neighbours
/// [m]: nearer than half of it, and never more than crowns of one stump reach.
double clump_reach_m(double spacing_m);

}  // namespace orchard::pose
