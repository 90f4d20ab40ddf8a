// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node_host.hpp"

#include <utility>

#include "bus/codec.hpp"

namespace orchard::bus {

NodeHost::NodeHost(Node& node, Publish publish) : node_(node), publish_(std::move(publish)) {
  outbox_ = [this](const Message& message) {
    ++num_published_;
    publish_({channel_of(message), seq_of(message), utime_of(message), encode(message)});
  };
}

bool NodeHost::receive(const Message& input) {
  if (!gate_.accept(channel_of(input), seq_of(input), utime_of(input))) return false;
  deliver(input);
  return true;
}

void NodeHost::deliver(const Message& input) {
  seen_[static_cast<std::size_t>(channel_of(input))] = true;
  ++num_handled_;
  node_.handle(input, outbox_);
}

void NodeHost::flush() { node_.flush(outbox_); }

}  // namespace orchard::bus
