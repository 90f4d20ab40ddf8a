// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "evaluation/map_evaluation.hpp"
#include "io/config/config.hpp"

namespace orchard::test {

/// Maps the paper's tube scene of a seed in this process - simulator, detector node, pose node,
/// mapper node - and compares the map with the truth.
evaluation::MapEvaluation run_tube_scene(std::uint64_t seed, const io::Config& config);

/// What a scene's map must satisfy; one sentence per thing that it does not, empty when all is
/// well. The limits are those of tests/RESULTS.md.
std::vector<std::string> shortcomings(const evaluation::MapEvaluation& evaluation);

}  // namespace orchard::test
