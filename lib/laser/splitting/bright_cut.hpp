// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "laser/beams.hpp"
#include "laser/cut.hpp"

namespace orchard::laser {

/// Makes each cluster of bright beams a candidate of its own: what stands close before or behind a
/// pole is not the pole, and one bright beam before a surface is no stray. What is left of the
/// candidates that it is cut out of stays on both sides. A candidate that `is_trunk` as a whole and
/// holds the cluster stays whole: its reflector is narrower than it.
void cut_at_bright(const Beams& beams, std::vector<Candidate>& candidates,
                   const std::function<bool(const Candidate&)>& is_trunk);

}  // namespace orchard::laser
