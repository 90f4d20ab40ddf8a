// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "mapping/rows/rows_config.hpp"
#include "viewer/map_editor.hpp"
#include "viewer/shared_live_state.hpp"

namespace orchard::procs {

/// Finds the rows of the growing map periodically in its own thread: in a large map this takes
/// seconds, and only the final map has row numbers. Applies the corrections made on the page or
/// elsewhere to the map.
class RowSurvey {
 public:
  /// `editor`: editor of the map's folder; null: no corrections.
  RowSurvey(SharedLiveState& box, const mapping::RowsConfig& config, MapEditor* editor);
  ~RowSurvey();
  RowSurvey(const RowSurvey&) = delete;
  RowSurvey& operator=(const RowSurvey&) = delete;

 private:
  void run();

  SharedLiveState& box_;
  mapping::RowsConfig config_;
  MapEditor* editor_;
  std::vector<mapping::Correction> corrections_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool is_stopping_ = false;
  std::thread thread_;
};

}  // namespace orchard::procs
