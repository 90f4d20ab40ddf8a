// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::io {

/// Cells are numbers, except in the first column and in `text_columns`.
struct DocumentTable {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;  ///< with as many cells as the head
  std::vector<std::size_t> text_columns{};
  bool has_sum = false;  ///< the last row is the sum of the others
};

/// A self-contained HTML page without script. Printed by a browser it fills A4 pages: tables
/// continue on the next page under a repeated head. All texts are escaped.
class Document {
 public:
  /// `language`: its code in HTML.
  Document(const std::string& language, const std::string& title, const std::string& subtitle);

  void add_heading(const std::string& text);
  void add_text(const std::string& text);
  void add_table(const DocumentTable& table);
  /// Adds an SVG picture, reduced to the page width if it is wider.
  void add_figure(const std::string& svg);

  std::string html() const;

 private:
  std::string html_;
  std::size_t num_figures_ = 0;
};

}  // namespace orchard::io
