// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace orchard::view {

/// Where the page comes from, which decides whom it may talk to.
enum class PageSource {
  kFile,    ///< opened from a disk: it asks nobody for anything
  kServer,  ///< served by orchard-viewer: it asks that server alone
};

/// The whole page as HTML with style, script and data inside. `title` is any text; `data_json` is
/// JSON as map_data_json() gives it. Whatever stands in either is shown, never executed.
std::string page_html(std::string_view title, std::string_view data_json, PageSource source);

/// The page's content security policy: nothing but its own script and style.
std::string page_policy(PageSource source);

}  // namespace orchard::view
