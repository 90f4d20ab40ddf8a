// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "view/live_state.hpp"

namespace orchard::procs {

/// State of a live drive, shared between the thread that receives messages and those that serve the
/// page. The writer waits for a reader at most as long as copying a thousand landmarks takes.
class SharedLiveState {
 public:
  explicit SharedLiveState(view::LiveState state) : state_(std::move(state)) {}

  /// Adds a message of any kind that LiveState takes.
  template <typename Message>
  void take(const Message& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    state_.take(message);
  }
  void take_status(std::string event) {
    const std::lock_guard<std::mutex> lock(mutex_);
    state_.take_status(std::move(event));
  }
  /// Returns the resulting increase of the map's revision.
  std::int64_t take_rows(const std::vector<mapping::Landmark>& numbered,
                         std::string rows_and_ways) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const std::int64_t before = state_.map_revision();
    state_.take_rows(numbered, std::move(rows_and_ways));
    return state_.map_revision() - before;
  }

  void take_corrected(const std::vector<mapping::Landmark>& corrected, std::string event) {
    const std::lock_guard<std::mutex> lock(mutex_);
    state_.take_corrected(corrected, std::move(event));
  }

  std::vector<std::string> events_for(view::ViewerProgress& seen, bool& is_more) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return state_.events_for(seen, is_more);
  }
  std::shared_ptr<const view::ShownPicture> picture() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return state_.picture();
  }
  std::int64_t map_revision() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return state_.map_revision();
  }
  std::shared_ptr<const mapping::NavigationGraph> ways() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return state_.ways();
  }
  std::vector<mapping::Landmark> landmarks() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return state_.landmarks();
  }

 private:
  mutable std::mutex mutex_;
  view::LiveState state_;
};

}  // namespace orchard::procs
