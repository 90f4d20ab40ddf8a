// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <deque>
#include <utility>
#include <vector>

#include "bus/messages/message.hpp"
#include "bus/node/node.hpp"

namespace orchard::test {

/// Hands every message, and what follows from it, to the nodes that read its channel.
class Wiring {
 public:
  explicit Wiring(std::vector<bus::Node*> nodes) : nodes_(std::move(nodes)) {}

  void put(bus::Message message) {
    waiting_.push_back(std::move(message));
    drain();
  }

  void flush() {
    for (bus::Node* node : nodes_) {
      node->flush(outbox());
      drain();
    }
  }

 private:
  bus::Outbox outbox() {
    return [this](bus::Message message) { waiting_.push_back(std::move(message)); };
  }

  void drain() {
    while (!waiting_.empty()) {
      const bus::Message message = std::move(waiting_.front());
      waiting_.pop_front();
      for (bus::Node* node : nodes_) {
        const auto channels = node->inputs();
        if (std::count(channels.begin(), channels.end(), bus::channel_of(message)) > 0) {
          node->handle(message, outbox());
        }
      }
    }
  }

  std::vector<bus::Node*> nodes_;
  std::deque<bus::Message> waiting_;
};

}  // namespace orchard::test
