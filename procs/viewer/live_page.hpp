// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "viewer/live_box.hpp"
#include "viewer/map_editor.hpp"
#include "viewer/page_content.hpp"

namespace orchard::procs {

/// The page of a live drive: what a LiveBox holds, and the picture that its last "look" is of.
class LivePage : public PageContent {
 public:
  /// `editor`: of the folder in which the mapper saves; null: the page is for looking on alone.
  /// `box` and `editor` outlive this.
  LivePage(LiveBox& box, MapEditor* editor, const std::string& version);

  std::string page() const override { return page_; }
  std::vector<std::string> events_for(view::Seen& seen, bool& is_more) const override {
    return box_.events_for(seen, is_more);
  }
  std::optional<PageAnswer> get(const std::string& name, const Parameters& parameters) override;
  bool can_edit() const override { return editor_ != nullptr; }
  PageAnswer edit(const std::string& json) override;

 private:
  LiveBox& box_;
  MapEditor* editor_;
  std::mutex edit_mutex_;
  std::string page_;
};

/// A page before anything is known: `mode` is "live" or "drive", `boot` a number of this server by
/// which the page tells it from another one at the same address.
std::string empty_page(const std::string& mode, const std::string& title,
                       const std::string& version, bool can_edit, const std::string& boot = "");

}  // namespace orchard::procs
