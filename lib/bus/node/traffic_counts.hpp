// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bus/messages/codec.hpp"
#include "bus/node/node.hpp"

namespace orchard::bus {

/// Messages handled, published, rejected and lost, for a log or a live process.
struct TrafficCounts {
  std::array<std::int64_t, kNumChannels> num_in{};   ///< messages passed to nodes
  std::array<std::int64_t, kNumChannels> num_out{};  ///< messages sent by nodes
  std::array<std::int64_t, kNumReasons> num_rejected{};
  std::int64_t num_duplicates = 0;
  std::int64_t num_seq_gaps = 0;  ///< messages missing by seq
};

/// Lists the counts by name as written to summary.json: channels with messages, all rejection
/// reasons, and the unused inputs of each node. Names contain no spaces.
std::vector<std::pair<std::string, std::int64_t>> named_counts(
    const TrafficCounts& traffic, const std::vector<const Node*>& nodes);

}  // namespace orchard::bus
