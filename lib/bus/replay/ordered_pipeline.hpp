// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace orchard::bus {

/// One processing step that is applied to every batch.
struct PipelineStage {
  /// True: batches pass one at a time and in order, so the stage may keep state. False: several
  /// batches may be processed at once.
  bool in_order = true;
  std::function<void(std::size_t slot)> work;
};

/// Sends batches of work through all stages, on the calling thread and `num_threads` - 1 others.
/// `fill` writes the next batch into a slot, or returns false at the end; it is called in order. At
/// most `num_slots` batches are in work at once; the last stage must be in order. If work throws,
/// the exception of the earliest batch is rethrown after all batches before it have passed every
/// stage.
///
/// The results of the ordered stages do not depend on the number of threads.
void run_pipeline(const std::function<bool(std::size_t slot)>& fill,
                  const std::vector<PipelineStage>& stages, int num_threads, std::size_t num_slots);

}  // namespace orchard::bus
