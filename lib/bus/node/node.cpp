// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/node.hpp"

#include <algorithm>

namespace orchard::bus {

std::vector<std::pair<std::string, std::int64_t>> named_counts(
    const TrafficCounts& traffic, const std::vector<const Node*>& nodes) {
  std::vector<std::pair<std::string, std::int64_t>> counts;
  for (const ChannelInfo& channel : kChannels) {
    const auto i = static_cast<std::size_t>(channel.channel);
    const std::string name(channel.name);
    if (traffic.num_in[i] > 0) counts.emplace_back("in_" + name, traffic.num_in[i]);
    if (traffic.num_out[i] > 0) counts.emplace_back("out_" + name, traffic.num_out[i]);
  }
  for (std::size_t i = 0; i < kNumReasons; ++i) {
    counts.emplace_back("refused_" + std::string(to_string(static_cast<Reason>(i))),
                        traffic.num_rejected[i]);
  }
  counts.emplace_back("duplicates", traffic.num_duplicates);
  counts.emplace_back("missing_by_seq", traffic.num_seq_gaps);
  for (const Node* node : nodes) {
    counts.emplace_back(std::string(node->name()) + "_late", node->counts().num_late);
    counts.emplace_back(std::string(node->name()) + "_unusable", node->counts().num_unusable);
  }
  for (auto& [name, value] : counts) std::replace(name.begin(), name.end(), ' ', '_');
  return counts;
}

}  // namespace orchard::bus
