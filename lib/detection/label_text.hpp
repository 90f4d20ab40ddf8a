// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "detection/detection.hpp"

namespace orchard::detection {

/// The name of a label in files and tables: "tree", "object" or "unseen".
inline const char* label_text(Label label) {
  switch (label) {
    case Label::kTree:
      return "tree";
    case Label::kObject:
      return "object";
    case Label::kUnseen:
      break;
  }
  return "unseen";
}

}  // namespace orchard::detection
