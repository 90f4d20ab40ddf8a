// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace orchard::view {

// The files of `web/` as they were when the program was built.
extern const std::string_view kPage;    ///< page.html, with {{NAME}} where something is put in
extern const std::string_view kStyle;   ///< style.css
extern const std::string_view kScript;  ///< every script, in order, as one function

// "sha256-..." of the two: by these a browser knows the page's own style and script, and runs no
// other (content security policy, level 2).
extern const std::string_view kStyleSum;
extern const std::string_view kScriptSum;

}  // namespace orchard::view
