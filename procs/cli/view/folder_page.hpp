// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "io/map/corrected_map.hpp"
#include "io/map/map_folder.hpp"
#include "view/live_state.hpp"
#include "view/map_data.hpp"
#include "view/map_tiles.hpp"
#include "viewer/map_editor.hpp"
#include "viewer/page_server.hpp"

namespace orchard::cli {

/// The page of a map folder with its corrections, including those that others make meanwhile.
class FolderPage : public procs::PageContent {
 public:
  /// Throws io::FileError. `can_edit`: users of the page may correct the map.
  FolderPage(const std::string& folder, bool can_edit);

  std::string page() const override;
  std::vector<std::string> events_for(view::ViewerProgress& seen, bool& is_more) const override;
  std::string hello() const override;
  /// `photo?id=17`; of a large map `tile?name=3_-2` and `tile?name=index`
  std::optional<procs::PageAnswer> get(const std::string& name,
                                       const Parameters& parameters) override;
  bool can_edit() const override { return can_edit_; }
  procs::PageAnswer edit(const std::string& json) override;

  /// Reads corrections that others have written beside the map.
  void look_for_corrections();

 private:
  struct Shown {
    io::CorrectedMapFolder map;
    io::MapSummary summary;
    std::optional<view::MapTiles> tiles{};  ///< of a large map; refers to the other members
  };
  std::shared_ptr<const Shown> shown() const;
  view::MapData page_data(const Shown& shown) const;
  std::optional<procs::PageAnswer> photo(const std::string& id) const;
  void show(io::CorrectedMapFolder map);

  std::string folder_, title_;
  bool can_edit_;
  std::string boot_;  ///< identifies this run of the server: the page of an earlier run reloads
  std::vector<std::int32_t> photo_ids_;
  std::mutex edit_mutex_;  ///< serialises edits, so that they are shown in order
  procs::MapEditor editor_;
  mutable std::mutex mutex_;  ///< guards all below, so that readers do not wait for an edit
  std::shared_ptr<const Shown> shown_;
  view::LiveMap landmarks_{0};
  std::string rows_event_, corrections_event_;
  std::int64_t num_shown_ = 0;
};

}  // namespace orchard::cli
