// SPDX-License-Identifier: BSD-3-Clause
#include "bus/replay/in_process_replay.hpp"

#include <algorithm>
#include <memory>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "bus/bus.hpp"
#include "bus/node/node_host.hpp"
#include "bus/replay/replay_index.hpp"

namespace orchard::bus {
namespace {

/// Nodes on a private bus, and what they have made since it was last collected.
class PrivateBus {
 public:
  PrivateBus(const std::vector<Node*>& nodes) : bus_("memq://") {
    bus_.on_rejection([](Channel channel, const Rejection& rejection) {
      // The sources were checked when the log was indexed, so this is a node's own message.
      throw std::logic_error("a node sent a " + std::string(info(channel).name) +
                             " that the guard refuses: " + rejection.detail);
    });
    for (Node* node : nodes) {
      hosts_.push_back(std::make_unique<NodeHost>(*node, [this](Output&& output) {
        bus_.publish(output.channel, output.bytes);
        made_.push_back(std::move(output));
      }));
    }
    std::set<Channel> channels;
    for (Node* node : nodes) {
      for (const Channel channel : node->inputs()) channels.insert(channel);
    }
    // One subscription per channel, so that a message is decoded once for all its consumers.
    for (const Channel channel : channels) {
      std::vector<NodeHost*> consumers;
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        const std::vector<Channel> inputs = nodes[i]->inputs();
        if (std::count(inputs.begin(), inputs.end(), channel) > 0) {
          consumers.push_back(hosts_[i].get());
        }
      }
      bus_.subscribe(channel, [consumers](const Message& message, Bytes) {
        for (NodeHost* consumer : consumers) consumer->deliver(message);
      });
    }
  }

  void input(Channel channel, const std::vector<std::uint8_t>& bytes) {
    bus_.publish(channel, bytes);
    drain();
  }

  void flush(std::size_t node) {
    hosts_[node]->flush();
    drain();
  }

  /// The outputs since the last call in order of (channel, seq): an order that does not depend on
  /// which of several nodes was faster, so that lockstep gives the same.
  std::vector<Output> collect() {
    std::stable_sort(made_.begin(), made_.end(), [](const Output& a, const Output& b) {
      return std::tie(a.channel, a.seq) < std::tie(b.channel, b.seq);
    });
    return std::exchange(made_, {});
  }

 private:
  void drain() {
    while (bus_.handle(0)) {
    }
  }

  Bus bus_;
  std::vector<std::unique_ptr<NodeHost>> hosts_;
  std::vector<Output> made_;
};

}  // namespace

ReplayReport replay_in_process(const io::LogPaths& logs, const std::vector<Node*>& nodes,
                               const ReplayOptions& options) {
  ReplayIndex index = index_log(logs, options);
  ReplayReport& report = index.report;
  PrivateBus bus(nodes);
  const auto pass_on = [&] {
    for (const Output& output : bus.collect()) {
      ++report.num_out[static_cast<std::size_t>(output.channel)];
      if (options.on_derived) options.on_derived(output.channel, output.utime, output.bytes);
    }
  };
  io::LogSeries reader(logs);
  std::uint64_t num_done = 0;
  for (const ReplayEntry& entry : index.entries) {
    bus.input(entry.channel, reader.read_at(entry.offset).data);
    ++report.num_in[static_cast<std::size_t>(entry.channel)];
    pass_on();
    if (options.progress) options.progress(++num_done, index.entries.size());
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    bus.flush(i);
    pass_on();
  }
  return std::move(report);
}

}  // namespace orchard::bus
