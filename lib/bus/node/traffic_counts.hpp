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

/// What went through nodes and what was lost on the way, of a log or of a live process.
struct TrafficCounts {
  std::array<std::int64_t, kNumChannels> num_in{};   ///< messages handed to nodes
  std::array<std::int64_t, kNumChannels> num_out{};  ///< messages that nodes made
  std::array<std::int64_t, kNumReasons> num_rejected{};
  std::int64_t num_duplicates = 0;
  std::int64_t num_seq_gaps = 0;  ///< messages missing by seq
};

/// The counts by name, as summary.json has them: channels with messages, every reason to refuse,
/// and what each node had to set aside. Names hold no blanks.
std::vector<std::pair<std::string, std::int64_t>> named_counts(
    const TrafficCounts& traffic, const std::vector<const Node*>& nodes);

}  // namespace orchard::bus
