// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "mapping/rows/rows.hpp"
#include "viewer/map_editor.hpp"
#include "viewer/shared_live_state.hpp"

namespace orchard::procs {

/// Shows rows periodically, from its own thread: in a large map finding them takes seconds. While
/// the map grows they are found in what MAP holds so far, without ways; the numbers and ways of the
/// finished map are taken as they are. Applies the corrections made on the page or elsewhere.
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
