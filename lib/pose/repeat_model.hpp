// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::pose {

/// Model of the probability that another visit detects an object again. Used by localisation in a
/// prior map, by the comparison of two maps and for persistent ids.
///
/// A trunk is detected in most scans that could show it, from all sides and on every day. A sucker
/// or a twig is detected in few: another visit drives another line, and a scanner that pitches by a
/// degree cuts another part of it. The detection rate of one visit therefore predicts that of
/// another only as well as two observations would, however many there were.

/// Returns the detection rate for `num_seen` of `num_chances` observations (>= 0), with half an
/// observation added to either side (Jeffreys' prior); within (0, 1).
double detection_rate(double num_seen, double num_chances);

/// Returns the probability that another visit detects an object at a rate above `rate_min`, given
/// the rate `rate` of one visit (both in [0, 1]). The other visit's rate is distributed as
/// Beta(2 rate, 2 (1 - rate)): same mean, with the spread of two observations.
double probability_seen_again(double rate, double rate_min);

/// Returns the probability that another visit detects the same part of a clump, if `num_others`
/// other parts are near: each visit detects one part at random.
inline double probability_same_part(int num_others) { return 1.0 / (1.0 + num_others); }

/// Returns the max distance between parts of one clump [m]: proportional to the usual distance
/// between neighbours `spacing_m`, but at most the extent of the crowns of one stump.
double clump_reach_m(double spacing_m);

}  // namespace orchard::pose
