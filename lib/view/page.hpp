// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace orchard::view {

/// Origin of the page, which determines its permitted connections.
enum class PageSource {
  kFile,           ///< opened from a disk: no connections
  kFileWithTiles,  ///< the same of a large map: scripts and pictures of the disk, no connections
  kServer,         ///< served by orchard-viewer: connections to that server only
};

/// Returns the page as HTML with embedded style, script and data. `title` is any text; `data_json`
/// is JSON from map_data_json(). Their content is displayed, never executed.
std::string page_html(std::string_view title, std::string_view data_json, PageSource source);

/// Makes a page of page_html(), of this program or an earlier one, anew, with a background
/// (map_data.hpp) in place of the one that it has. "" if `html` is no such page.
std::string with_background(std::string_view html, std::string_view background_json);

/// Content security policy of the page: only its own script and style.
std::string page_policy(PageSource source);

}  // namespace orchard::view
