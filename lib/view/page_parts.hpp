// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace orchard::view {

// The files of `web/` as of the build.
extern const std::string_view kPage;    ///< page.html, with {{NAME}} placeholders
extern const std::string_view kStyle;   ///< style.css
extern const std::string_view kScript;  ///< all scripts, in order, as one function

// "sha256-..." of style and script: with these hashes in the content security policy (level 2) a
// browser executes no other script or style.
extern const std::string_view kStyleSum;
extern const std::string_view kScriptSum;

}  // namespace orchard::view
