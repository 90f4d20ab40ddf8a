// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "io/figure/canvas.hpp"

namespace orchard::io {

struct DocumentHeading {
  std::string text;
};

struct DocumentText {
  std::string text;
};

/// Cells are numbers, except in the first column and in `text_columns`.
struct DocumentTable {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;  ///< with as many cells as the head
  std::vector<std::size_t> text_columns{};
  bool has_sum = false;  ///< the last row is the sum of the others
};

/// A drawing of that size, reduced to the page width if it is wider.
struct DocumentFigure {
  int width_px = 0;
  int height_px = 0;
  std::function<void(Canvas&)> draw;
};

using DocumentPart = std::variant<DocumentHeading, DocumentText, DocumentTable, DocumentFigure>;

/// A printable document.
struct Document {
  std::string language = "en";  ///< language code of HTML
  std::string title;
  std::string subtitle;
  std::vector<DocumentPart> parts;
};

/// Returns a self-contained HTML page without script. Printed by a browser it fills A4 pages:
/// tables continue on the next page under a repeated head. All texts are escaped.
std::string document_html(const Document& document);

}  // namespace orchard::io
