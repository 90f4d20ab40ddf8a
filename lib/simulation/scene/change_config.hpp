// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::simulation {

/// What a later day has changed in scene orchard. Section `simulation.change`. Everything else
/// stays as the seed made it: compare a drive with this section to one without.
struct ChangeConfig {
  double fraction = 0.0;        ///< of the trees are gone, and as many new ones fill empty places
  double moved_fraction = 0.0;  ///< of the trees stand somewhere else nearby
  double moved_m = 0.6;         ///< how far at least
  double moved_spread_m = 0.0;  ///< and by up to how much farther
  double growth_m = 0.0;  ///< mean by which trunks have grown wider; its sd is a quarter of it
  double grown_fraction = 1.0;    ///< of the trees have grown
  double objects_fraction = 0.0;  ///< of posts and bushes are gone; others stand elsewhere
  int seed = 1;                   ///< which ones
};

template <class Visitor>
void describe(Visitor& v, ChangeConfig& c) {
  v.number(
      "fraction", c.fraction, 0, 1, "1",
      "of the trees are gone, and as many new ones fill empty places, as far as there are any");
  v.number("moved_fraction", c.moved_fraction, 0, 1, "1", "of the trees stand elsewhere nearby");
  v.number("moved_m", c.moved_m, 0.05, 5, "m", "how far at least");
  v.number("moved_spread_m", c.moved_spread_m, 0, 5, "m", "and by up to how much farther");
  v.number("growth_m", c.growth_m, 0, 0.5, "m", "mean by which trunks have grown wider");
  v.number("grown_fraction", c.grown_fraction, 0, 1, "1", "of the trees have grown");
  v.number("objects_fraction", c.objects_fraction, 0, 1, "1",
           "of posts and bushes are gone, and as many stand in other places of the rows");
  v.integer("seed", c.seed, 0, 2147483647, "1", "which trees, with the scene's own seed");
}

}  // namespace orchard::simulation
