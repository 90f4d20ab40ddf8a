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

/// Cells are numbers, except those of the first column and of columns named in `text_columns`.
struct DocumentTable {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;  ///< as many cells as the head
  std::vector<std::size_t> text_columns{};
  bool has_sum = false;  ///< the last row is the sum of the others
};

/// A drawing of that size, scaled to the page's width where it is wider.
struct DocumentFigure {
  int width_px = 0;
  int height_px = 0;
  std::function<void(Canvas&)> draw;
};

using DocumentPart = std::variant<DocumentHeading, DocumentText, DocumentTable, DocumentFigure>;

/// Something to print, whatever the form.
struct Document {
  std::string language = "en";  ///< as HTML names it
  std::string title;
  std::string subtitle;
  std::string day{};      ///< of the PDF's making, "2026-11-22"
  std::string page_word;  ///< before page numbers
  std::vector<DocumentPart> parts;
};

/// One HTML page with everything inside and no script, which prints well. All texts are escaped.
std::string document_html(const Document& document);

/// The same on A4 pages. Tables go on over pages under their heads.
std::string document_pdf(const Document& document);

}  // namespace orchard::io
