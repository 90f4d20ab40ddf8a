// SPDX-License-Identifier: BSD-3-Clause
#include "bus/replay/node_chain.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "bus/messages/codec.hpp"

namespace orchard::bus {
namespace {

bool is_before(const std::vector<std::int32_t>& a, const std::vector<std::int32_t>& b) {
  return a.size() != b.size() ? a.size() < b.size() : a < b;
}

}  // namespace

NodeChain::NodeChain(const std::vector<Node*>& nodes) : nodes_(nodes), sinks_(nodes.size()) {
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    std::vector<bool> reads(kNumChannels, false);
    for (const Channel channel : nodes[i]->inputs())
      reads[static_cast<std::size_t>(channel)] = true;
    reads_.push_back(std::move(reads));
    hosts_.push_back(std::make_unique<NodeHost>(
        *nodes[i], [this, i](Output&& output) { take_output(i, std::move(output)); }));
  }
}

bool NodeChain::is_read_from(std::size_t node, Channel channel) const {
  for (; node < reads_.size(); ++node) {
    if (reads_[node][static_cast<std::size_t>(channel)]) return true;
  }
  return false;
}

void NodeChain::precompute(ReplayEvent& event) const {
  event.precomputed.clear();
  if (!event.source) return;
  const auto channel = static_cast<std::size_t>(channel_of(*event.source));
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    event.precomputed.push_back(reads_[i][channel] ? nodes_[i]->precompute(*event.source)
                                                   : nullptr);
  }
}

void NodeChain::compute_ahead(ReplayEvent& event) {
  for (const auto& precomputed : event.precomputed) {
    if (precomputed) precomputed->compute();
  }
}

void NodeChain::pass(std::size_t node, ReplayEvent& event) {
  NodeHost& host = *hosts_[node];
  Sink& sink = sinks_[node];
  sink.event = &event;
  const std::vector<bool>& reads = reads_[node];
  std::vector<std::size_t> inputs;  // outputs of earlier nodes; this node appends its own
  for (std::size_t i = 0; i < event.derived.size(); ++i) {
    const ReplayEvent::Derived& derived = event.derived[i];
    if (reads[static_cast<std::size_t>(derived.output.channel)]) inputs.push_back(i);
  }
  std::sort(inputs.begin(), inputs.end(), [&event](std::size_t a, std::size_t b) {
    return is_before(event.derived[a].way, event.derived[b].way);
  });
  const auto begin = [&sink](std::vector<std::int32_t> cause) {
    sink.cause = std::move(cause);
    sink.num_sent = 0;
  };
  begin({});
  if (!event.source) {
    if (event.flushed_node == node) host.flush();
  } else if (reads[static_cast<std::size_t>(channel_of(*event.source))]) {
    if (node < event.precomputed.size())
      host.node().use_precomputed(std::move(event.precomputed[node]));
    host.deliver(*event.source);
  }
  for (const std::size_t i : inputs) {
    begin(event.derived[i].way);
    host.deliver(*event.derived[i].message);
  }
}

void NodeChain::take_output(std::size_t node, Output&& output) {
  Sink& sink = sinks_[node];
  ReplayEvent::Derived derived{sink.cause, {}, std::nullopt};
  derived.way.push_back(static_cast<std::int32_t>(node));
  derived.way.push_back(sink.num_sent++);
  const std::string name(info(output.channel).name);
  for (std::size_t i = 0; i <= node; ++i) {
    if (reads_[i][static_cast<std::size_t>(output.channel)]) {
      throw std::logic_error("a node reads " + name + ", which it or a later node sends");
    }
  }
  if (is_read_from(node + 1, output.channel)) {
    auto decoded = decode(output.channel, output.bytes.data(), output.bytes.size());
    if (const auto* rejection = std::get_if<Rejection>(&decoded)) {
      throw std::logic_error("a node sent a " + name +
                             " that the guard refuses: " + rejection->detail);
    }
    derived.message = std::get<Message>(std::move(decoded));
  }
  derived.output = std::move(output);
  sink.event->derived.push_back(std::move(derived));
}

}  // namespace orchard::bus
