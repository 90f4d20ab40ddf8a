// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace orchard::bus {

/// One thing that is done to every batch of work.
struct PipelineStage {
  /// The batches come one at a time and in order, so that the stage may have a state of its own;
  /// else several may be worked on at once.
  bool in_order = true;
  std::function<void(std::size_t slot)> work;
};

/// Sends batches of work through stages, on the calling thread and `num_threads` - 1 more: each
/// batch through all stages in their order. `fill` puts the next batch into a slot, or says that
/// there is none; it is called like a stage that is in order. At most `num_slots` batches are on
/// their way at once. Of work that throws, what the earliest batch threw is thrown here, after all
/// batches before it are through every stage; the last stage must be in order.
///
/// What the stages in order make does not depend on the number of threads.
void run_pipeline(const std::function<bool(std::size_t slot)>& fill,
                  const std::vector<PipelineStage>& stages, int num_threads, std::size_t num_slots);

}  // namespace orchard::bus
