// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/node.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "bus/messages/codec.hpp"

namespace orchard::bus {

std::string warning_text(const Node& node) {
  std::string text = node.warning();
  for (const Finding& finding : node.findings()) {
    text += (text.empty() ? "" : "; ") + finding.text;
  }
  return text;
}

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

NodeHost::NodeHost(Node& node, Publish publish) : node_(node), publish_(std::move(publish)) {
  outbox_ = [this](const Message& message) {
    ++traffic_.num_out[static_cast<std::size_t>(channel_of(message))];
    const std::int64_t drive_time = utime_of(message);
    publish_({channel_of(message), seq_of(message), timing::utime_of(drive_time), encode(message),
              drive_time});
  };
}

bool NodeHost::receive(Message input, std::optional<std::int64_t> arrival_us) {
  const Channel channel = channel_of(input);
  const std::int32_t seq = seq_of(input);
  const std::int64_t utime = utime_of(input);
  auto used = gated_.add(channel, seq, utime, arrival_us, std::move(input));
  if (gated_.was_reordered()) return false;  // nodes require increasing seq
  for (auto& [drive_time, message] : used) deliver_at(drive_time, std::move(message));
  return !used.empty();
}

void NodeHost::deliver_as_sent(Message input) {
  const auto drive_time = gated_.gate().drive_time(channel_of(input), utime_of(input));
  if (drive_time) deliver_at(*drive_time, std::move(input));
}

void NodeHost::deliver_at(std::int64_t drive_time, Message input) {
  set_drive_time(input, drive_time);
  deliver(input);
}

void NodeHost::deliver(const Message& input) {
  ++traffic_.num_in[static_cast<std::size_t>(channel_of(input))];
  node_.handle(input, outbox_);
}

void NodeHost::flush() { node_.flush(outbox_); }

std::int64_t NodeHost::num_handled() const {
  return std::accumulate(traffic_.num_in.begin(), traffic_.num_in.end(), std::int64_t{0});
}

std::int64_t NodeHost::num_published() const {
  return std::accumulate(traffic_.num_out.begin(), traffic_.num_out.end(), std::int64_t{0});
}

TrafficCounts NodeHost::traffic() const {
  TrafficCounts traffic = traffic_;
  traffic.num_duplicates = gated_.gate().counts().num_duplicate;
  traffic.num_seq_gaps = gated_.gate().counts().num_lost;
  return traffic;
}

}  // namespace orchard::bus
