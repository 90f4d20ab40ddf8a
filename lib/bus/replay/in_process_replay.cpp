// SPDX-License-Identifier: BSD-3-Clause
#include "bus/replay/in_process_replay.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <tuple>
#include <utility>

#include "bus/replay/ordered_pipeline.hpp"
#include "bus/replay/replay_index.hpp"
#include "io/file_error.hpp"

namespace orchard::bus {
namespace {

/// A batch is large enough that the cost of passing it on is negligible, and small enough that all
/// batches in work need little memory.
constexpr std::size_t kBatchEvents = 64;
constexpr std::size_t kBatchBytes = 1u << 20;

/// A source message on its way through the nodes, with the messages derived from it so far.
struct ReplayEvent {
  ReplayEvent() = default;
  ReplayEvent(ReplayEvent&&) = default;
  ReplayEvent& operator=(ReplayEvent&&) = default;

  /// A message sent by a node.
  struct Derived {
    /// Chain of causes from the source message on: pairs of (node, index among its outputs).
    /// Shorter chains come first, as on a bus that delivers in turn.
    std::vector<std::int32_t> way;
    Output output;
    std::optional<Message> message;  ///< decoded, if a later node reads its channel
  };

  std::optional<Message> source;                             ///< none: the event is only a flush
  std::size_t flushed_node = 0;                              ///< for an event without source
  std::vector<std::unique_ptr<Precomputation>> precomputed;  ///< one per node
  /// Pointers: appending does not move what a node is reading.
  std::vector<std::unique_ptr<Derived>> derived;
};

/// A chain of nodes, each reading source messages and outputs of earlier nodes. Every node gets its
/// inputs in the order of a bus that is drained after each source message, even while earlier nodes
/// already process later events.
class NodeChain {
 public:
  explicit NodeChain(const std::vector<Node*>& nodes);

  std::size_t size() const { return nodes_.size(); }
  bool is_read(Channel channel) const { return is_read_from(0, channel); }

  /// Asks every node for work that can be computed in advance. Call for events in order.
  void precompute(ReplayEvent& event) const;
  /// Computes that work; may run for several events at once.
  static void compute_ahead(ReplayEvent& event);
  /// Passes the event's messages to one node. Call for events in order, after the earlier nodes.
  /// Throws std::logic_error for an output that is invalid, or that this or an earlier node reads.
  void pass(std::size_t node, ReplayEvent& event);

 private:
  bool is_read_from(std::size_t node, Channel channel) const;
  void take_output(std::size_t node, Output&& output);

  std::vector<Node*> nodes_;
  std::vector<std::vector<bool>> reads_;  ///< node, channel
  /// Receives a node's outputs while it is in pass().
  struct Sink {
    ReplayEvent* event = nullptr;
    std::vector<std::int32_t> cause;  ///< chain of causes of the message being handled
    std::int32_t num_sent = 0;
  };
  std::vector<Sink> sinks_;
  std::vector<std::unique_ptr<NodeHost>> hosts_;
};

bool is_before(const std::vector<std::int32_t>& a, const std::vector<std::int32_t>& b) {
  return a.size() != b.size() ? a.size() < b.size() : a < b;
}

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
  event.precomputed.reserve(nodes_.size());
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
    const ReplayEvent::Derived& derived = *event.derived[i];
    if (reads[static_cast<std::size_t>(derived.output.channel)]) inputs.push_back(i);
  }
  std::sort(inputs.begin(), inputs.end(), [&event](std::size_t a, std::size_t b) {
    return is_before(event.derived[a]->way, event.derived[b]->way);
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
    begin(event.derived[i]->way);
    host.deliver(*event.derived[i]->message);
  }
}

void NodeChain::take_output(std::size_t node, Output&& output) {
  Sink& sink = sinks_[node];
  ReplayEvent::Derived derived;
  derived.way.reserve(sink.cause.size() + 2);
  derived.way = sink.cause;
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
    set_drive_time(*derived.message, output.drive_time);
  }
  derived.output = std::move(output);
  sink.event->derived.push_back(std::make_unique<ReplayEvent::Derived>(std::move(derived)));
}

/// Events that pass through the nodes together.
struct Batch {
  Batch() = default;
  Batch(Batch&&) = default;
  Batch& operator=(Batch&&) = default;

  std::vector<ReplayEntry> entries;  ///< empty: flush of a node
  std::vector<std::vector<std::uint8_t>> bytes;
  std::vector<ReplayEvent> events;
};

class Replay {
 public:
  Replay(const io::LogPaths& logs, const std::vector<Node*>& nodes, const ReplayOptions& options)
      : options_(options),
        index_(index_log(logs, options)),
        next_entry_(index_.entries.begin()),
        reader_(logs),
        chain_(nodes),
        num_threads_(num_threads(options.num_jobs)),
        batches_(num_threads_ == 1 ? 1 : 2 * num_threads_ + nodes.size()) {}

  ReplayReport run() {
    const auto in_turn = [this](auto work) {
      return PipelineStage{true, [this, work](std::size_t slot) { work(batches_[slot]); }};
    };
    const auto at_once = [this](auto work) {
      return PipelineStage{false, [this, work](std::size_t slot) { work(batches_[slot]); }};
    };
    std::vector<PipelineStage> stages{at_once([this](Batch& batch) { decode_all(batch); })};
    if (num_threads_ > 1) {
      stages.push_back(in_turn([this](Batch& batch) {
        for (ReplayEvent& event : batch.events) chain_.precompute(event);
      }));
      stages.push_back(at_once([](Batch& batch) {
        for (ReplayEvent& event : batch.events) NodeChain::compute_ahead(event);
      }));
    }
    for (std::size_t node = 0; node < chain_.size(); ++node) {
      stages.push_back(in_turn([this, node](Batch& batch) {
        for (ReplayEvent& event : batch.events) chain_.pass(node, event);
      }));
    }
    stages.push_back(in_turn([this](Batch& batch) { pass_on(batch); }));
    run_pipeline([this](std::size_t slot) { return fill(batches_[slot]); }, stages,
                 static_cast<int>(num_threads_), batches_.size());
    return std::move(index_.report);
  }

 private:
  static std::size_t num_threads(int num_jobs) {
    return num_jobs > 0 ? static_cast<std::size_t>(num_jobs)
                        : std::max(1u, std::thread::hardware_concurrency());
  }

  /// A single thread takes one event at a time, so that the callbacks follow each event at once.
  bool fill(Batch& batch) {
    batch = {};
    std::size_t num_bytes = 0;
    const std::size_t num_events = num_threads_ == 1 ? 1 : kBatchEvents;
    while (batch.entries.size() < num_events && num_bytes < kBatchBytes &&
           next_entry_ != index_.entries.end()) {
      const ReplayEntry& entry = batch.entries.emplace_back(*next_entry_);
      ++next_entry_;
      batch.bytes.emplace_back();
      if (chain_.is_read(entry.channel)) {
        batch.bytes.back() = reader_.read_at(entry.offset).data;
        num_bytes += batch.bytes.back().size();
      }
    }
    if (!batch.entries.empty()) return true;
    if (next_flushed_ == chain_.size()) return false;
    batch.events.resize(1);
    batch.events.front().flushed_node = next_flushed_++;
    return true;
  }

  void decode_all(Batch& batch) const {
    if (batch.entries.empty()) return;
    batch.events.resize(batch.entries.size());
    for (std::size_t i = 0; i < batch.entries.size(); ++i) {
      const ReplayEntry& entry = batch.entries[i];
      ReplayEvent& event = batch.events[i];
      event.flushed_node = chain_.size();
      if (!chain_.is_read(entry.channel)) continue;
      auto decoded = decode(entry.channel, batch.bytes[i].data(), batch.bytes[i].size());
      if (const auto* rejection = std::get_if<Rejection>(&decoded)) {
        throw io::FileError(reader_.where(entry.offset) +
                            ": the log was changed while it was read: " + rejection->detail);
      }
      event.source = std::get<Message>(std::move(decoded));
      set_drive_time(*event.source, entry.drive_time);
    }
  }

  /// Passes on the outputs of each event in order of (channel, seq). This order does not depend on
  /// which node was faster, so lockstep gives the same one.
  void pass_on(Batch& batch) {
    ReplayReport& report = index_.report;
    for (std::size_t i = 0; i < batch.events.size(); ++i) {
      if (!batch.entries.empty()) {
        ++report.num_in[static_cast<std::size_t>(batch.entries[i].channel)];
      }
      std::vector<const Output*> made;
      for (const auto& derived : batch.events[i].derived) made.push_back(&derived->output);
      std::stable_sort(made.begin(), made.end(), [](const Output* a, const Output* b) {
        return std::tie(a->channel, a->seq) < std::tie(b->channel, b->seq);
      });
      for (const Output* output : made) {
        ++report.num_out[static_cast<std::size_t>(output->channel)];
        if (options_.on_derived) options_.on_derived(output->channel, output->utime, output->bytes);
      }
      if (options_.progress && !batch.entries.empty()) {
        options_.progress(++num_done_, index_.entries.size());
      }
    }
  }

  const ReplayOptions& options_;
  ReplayIndex index_;
  ReplayEntries::Iterator next_entry_;
  io::LogSeries reader_;
  NodeChain chain_;
  std::size_t num_threads_;
  std::vector<Batch> batches_;
  std::size_t next_flushed_ = 0;
  std::uint64_t num_done_ = 0;
};

}  // namespace

ReplayReport replay_in_process(const io::LogPaths& logs, const std::vector<Node*>& nodes,
                               const ReplayOptions& options) {
  return Replay(logs, nodes, options).run();
}

}  // namespace orchard::bus
