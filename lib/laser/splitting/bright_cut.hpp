// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "laser/beams.hpp"
#include "laser/candidate.hpp"

namespace orchard::laser {

/// Makes each cluster of bright beams a separate candidate, so that a pole with a reflector is
/// distinguished from objects close to it, even with a single bright beam. The rest of the
/// candidates that a cluster is cut out of remains on both sides. A candidate that contains the
/// whole cluster and for which `is_trunk` is true is not cut: a trunk with a narrower reflector.
void cut_at_bright(const Beams& beams, std::vector<Candidate>& candidates,
                   const std::function<bool(const Candidate&)>& is_trunk);

}  // namespace orchard::laser
