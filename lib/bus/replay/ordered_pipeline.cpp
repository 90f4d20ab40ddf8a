// SPDX-License-Identifier: BSD-3-Clause
#include "bus/replay/ordered_pipeline.hpp"

#include <algorithm>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <limits>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>

namespace orchard::bus {
namespace {

/// State of the batches in work and the assignment of threads to them.
class OrderedPipeline {
 public:
  OrderedPipeline(const std::function<bool(std::size_t)>& fill,
                  const std::vector<PipelineStage>& stages, std::size_t num_slots)
      : fill_(fill), stages_(stages), next_of_stage_(stages.size(), 0), slots_(num_slots) {}

  /// Loop of each thread; returns when no work is left.
  void work() {
    std::unique_lock<std::mutex> lock(mutex_);
    while (!is_done()) {
      if (const auto batch = runnable()) {
        run(*batch, lock);
      } else if (can_fill()) {
        fill(lock);
      } else {
        changed_.wait(lock);
      }
    }
    changed_.notify_all();
  }

  std::exception_ptr error() const { return error_; }

 private:
  struct Slot {
    std::size_t stage = 0;  ///< next stage
    bool is_busy = false;
    std::exception_ptr error;  ///< exception of a stage; later stages skip the batch
  };

  Slot& slot_of(std::uint64_t batch) { return slots_[batch % slots_.size()]; }
  bool is_done() const { return is_ended_ && !is_filling_ && oldest_ == num_filled_; }
  bool can_fill() const {
    return !is_ended_ && !is_filling_ && num_filled_ - oldest_ < slots_.size();
  }

  /// The oldest batch that can proceed, to keep the number of batches in work small.
  std::optional<std::uint64_t> runnable() {
    for (std::uint64_t batch = oldest_; batch < num_filled_; ++batch) {
      const Slot& slot = slot_of(batch);
      if (slot.is_busy) continue;
      if (!stages_[slot.stage].in_order || next_of_stage_[slot.stage] == batch) return batch;
    }
    return std::nullopt;
  }

  void run(std::uint64_t batch, std::unique_lock<std::mutex>& lock) {
    Slot& slot = slot_of(batch);
    const PipelineStage& stage = stages_[slot.stage];
    slot.is_busy = true;
    if (!slot.error && batch < first_bad_) {  // batches after a failed one are never passed on
      lock.unlock();
      std::exception_ptr error;
      try {
        stage.work(batch % slots_.size());
      } catch (...) {
        error = std::current_exception();
      }
      lock.lock();
      slot.error = error;
      if (error) first_bad_ = std::min(first_bad_, batch);
    }
    slot.is_busy = false;
    if (stage.in_order) ++next_of_stage_[slot.stage];
    if (++slot.stage == stages_.size()) {
      if (slot.error && !error_) {
        error_ = slot.error;
        is_ended_ = true;
        num_filled_ = batch + 1;  // later batches are abandoned
      }
      slot = {};
      ++oldest_;
    }
    changed_.notify_all();
  }

  void fill(std::unique_lock<std::mutex>& lock) {
    is_filling_ = true;
    const std::uint64_t batch = num_filled_;
    lock.unlock();
    bool is_filled = false;
    std::exception_ptr error;
    try {
      is_filled = fill_(batch % slots_.size());
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    is_filling_ = false;
    if (error_) {  // an earlier batch has failed meanwhile
    } else if (is_filled || error) {
      slot_of(batch).error = error;
      ++num_filled_;
      if (error) is_ended_ = true;
    } else {
      is_ended_ = true;
    }
    changed_.notify_all();
  }

  const std::function<bool(std::size_t)>& fill_;
  const std::vector<PipelineStage>& stages_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::uint64_t> next_of_stage_;  ///< next batch of each ordered stage
  std::vector<Slot> slots_;
  std::uint64_t oldest_ = 0;      ///< oldest batch that is not finished
  std::uint64_t num_filled_ = 0;  ///< number of batches so far
  bool is_filling_ = false;
  bool is_ended_ = false;  ///< no batch follows
  /// Earliest batch known to have failed.
  std::uint64_t first_bad_ = std::numeric_limits<std::uint64_t>::max();
  std::exception_ptr error_;
};

}  // namespace

void run_pipeline(const std::function<bool(std::size_t slot)>& fill,
                  const std::vector<PipelineStage>& stages, int num_threads,
                  std::size_t num_slots) {
  OrderedPipeline pipeline(fill, stages, num_slots);
  std::vector<std::thread> threads;
  try {
    for (int i = 1; i < num_threads; ++i) threads.emplace_back([&pipeline] { pipeline.work(); });
  } catch (const std::system_error&) {  // no more threads available: continue with those that exist
  }
  pipeline.work();
  for (std::thread& thread : threads) thread.join();
  if (pipeline.error()) std::rethrow_exception(pipeline.error());
}

}  // namespace orchard::bus
