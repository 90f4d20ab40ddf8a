// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "mapping/rows/rows_config.hpp"
#include "viewer/live_box.hpp"

namespace orchard::procs {

/// Finds the rows of the growing map from time to time, in a thread of its own: over a large map
/// that takes seconds, and only the finished map carries numbers.
class RowSurvey {
 public:
  RowSurvey(LiveBox& box, const mapping::RowsConfig& config);
  ~RowSurvey();
  RowSurvey(const RowSurvey&) = delete;
  RowSurvey& operator=(const RowSurvey&) = delete;

 private:
  void run();

  LiveBox& box_;
  mapping::RowsConfig config_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool is_stopping_ = false;
  std::thread thread_;
};

}  // namespace orchard::procs
