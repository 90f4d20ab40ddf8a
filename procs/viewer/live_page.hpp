// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "mapping/rows/rows.hpp"
#include "view/live_state.hpp"
#include "viewer/map_editor.hpp"
#include "viewer/page_server.hpp"

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

/// The page of a live drive: the content of a SharedLiveState and the picture of its last "look"
/// event.
class LivePage : public PageContent {
 public:
  /// `editor`: editor of the mapper's folder; null: the page is read-only. `box` and `editor` must
  /// outlive this.
  LivePage(SharedLiveState& box, MapEditor* editor, const std::string& title,
           const std::string& version);

  std::string page() const override { return page_; }
  std::vector<std::string> events_for(view::ViewerProgress& seen, bool& is_more) const override {
    return box_.events_for(seen, is_more);
  }
  std::optional<PageAnswer> get(const std::string& name, const Parameters& parameters) override;
  bool can_edit() const override { return editor_ != nullptr; }
  PageAnswer edit(const std::string& json) override;

 private:
  SharedLiveState& box_;
  MapEditor* editor_;
  std::mutex edit_mutex_;
  std::string page_;
};

/// An empty page: `mode` is "live" or "drive"; `boot` identifies this run of the server, so that
/// the page can detect a restart at the same address.
std::string empty_page(const std::string& mode, const std::string& title,
                       const std::string& version, bool can_edit, const std::string& boot = "");

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
