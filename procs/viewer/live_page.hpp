// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "viewer/map_editor.hpp"
#include "viewer/page_content.hpp"
#include "viewer/shared_live_state.hpp"

namespace orchard::procs {

/// The page of a live drive: the content of a SharedLiveState and the picture of its last "look"
/// event.
class LivePage : public PageContent {
 public:
  /// `editor`: editor of the mapper's folder; null: the page is read-only. `box` and `editor` must
  /// outlive this.
  LivePage(SharedLiveState& box, MapEditor* editor, const std::string& version);

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

}  // namespace orchard::procs
