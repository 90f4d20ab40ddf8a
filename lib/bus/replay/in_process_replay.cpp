// SPDX-License-Identifier: BSD-3-Clause
#include "bus/replay/in_process_replay.hpp"

#include <algorithm>
#include <thread>
#include <tuple>
#include <utility>

#include "bus/replay/node_chain.hpp"
#include "bus/replay/ordered_pipeline.hpp"
#include "bus/replay/replay_index.hpp"
#include "io/file_error.hpp"

namespace orchard::bus {
namespace {

/// A batch is large enough that the cost of passing it on is negligible, and small enough that all
/// batches in work need little memory.
constexpr std::size_t kBatchEvents = 64;
constexpr std::size_t kBatchBytes = 1u << 20;

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
      for (const ReplayEvent::Derived& derived : batch.events[i].derived) {
        made.push_back(&derived.output);
      }
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
