// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "io/report/document.hpp"

namespace orchard::io {
namespace {

constexpr int kPageWidth_px = 794, kPageHeight_px = 1123;  // A4 at 96 dpi
constexpr double kMargin_px = 60.0, kWidth_px = kPageWidth_px - 2.0 * kMargin_px;
constexpr double kBottom_px = kPageHeight_px - kMargin_px;
constexpr double kText_px = 12.0, kLine_px = 17.0, kTableText_px = 11.0, kRow_px = 16.0;
constexpr double kCellGap_px = 9.0;
constexpr Colour kInk{34, 34, 34}, kSoft{95, 95, 95}, kRule{190, 190, 190};

/// Breaks a text into lines of at most that width; a longer word extends beyond it.
std::vector<std::string> lines_of(const std::string& text, double width_px, double size_px) {
  std::vector<std::string> lines(1);
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t end = std::min(text.size(), text.find(' ', i));
    const std::string word = text.substr(i, end - i);
    const std::string longer = lines.back().empty() ? word : lines.back() + " " + word;
    if (lines.back().empty() || text_width_px(longer, size_px) <= width_px) {
      lines.back() = longer;
    } else {
      lines.push_back(word);
    }
    i = end + 1;
  }
  return lines;
}

class PdfWriter {
 public:
  explicit PdfWriter(const Document& document)
      : document_(document), canvas_(FigureFormat::kPdf, kPageWidth_px, kPageHeight_px) {
    canvas_.set_day(document.day);
    y_px_ = kMargin_px + 10.0;
    canvas_.text({kMargin_px, y_px_}, document.title, {22.0, kInk, TextAnchor::kStart, true});
    y_px_ += 22.0;
    for (const std::string& line : lines_of(document.subtitle, kWidth_px, kText_px)) {
      canvas_.text({kMargin_px, y_px_}, line, {kText_px, kSoft});
      y_px_ += kLine_px;
    }
    y_px_ += 6.0;
  }

  /// Starts a new page if the heading would be alone at the end of a page.
  void begin_section(const DocumentPart* next) {
    constexpr double kHeading_px = 46.0, kBeginning_px = 64.0;
    const auto* figure = next != nullptr ? std::get_if<DocumentFigure>(next) : nullptr;
    need(kHeading_px +
         (figure != nullptr ? figure_scale(*figure) * figure->height_px : kBeginning_px));
  }

  void operator()(const DocumentHeading& it) {
    y_px_ += 20.0;
    canvas_.text({kMargin_px, y_px_}, it.text, {15.0, kInk, TextAnchor::kStart, true});
    canvas_.line({kMargin_px, y_px_ + 6.0}, {kMargin_px + kWidth_px, y_px_ + 6.0}, kRule, 1.0);
    y_px_ += 26.0;
  }

  void operator()(const DocumentText& it) {
    for (const std::string& line : lines_of(it.text, kWidth_px, kText_px)) {
      need(kLine_px);
      canvas_.text({kMargin_px, y_px_}, line, {kText_px, kInk});
      y_px_ += kLine_px;
    }
    y_px_ += 4.0;
  }

  void operator()(const DocumentTable& it) {
    const std::vector<double> widths_px = column_widths(it);
    need(5.0 * kRow_px);
    draw_row(it, it.head, widths_px, true);
    for (std::size_t r = 0; r < it.rows.size(); ++r) {
      const double height_px = kRow_px * num_lines(it, it.rows[r], widths_px);
      if (y_px_ + height_px > kBottom_px) {
        next_page();
        draw_row(it, it.head, widths_px, true);
      }
      draw_row(it, it.rows[r], widths_px, it.has_sum && r + 1 == it.rows.size());
    }
    y_px_ += 8.0;
  }

  void operator()(const DocumentFigure& it) {
    const double scale = figure_scale(it);
    need(scale * it.height_px + 6.0);
    canvas_.begin_inset({kMargin_px, y_px_ - 8.0}, scale);
    it.draw(canvas_);
    canvas_.end_inset();
    y_px_ += scale * it.height_px + 10.0;
  }

  std::string finish() {
    draw_page_number();
    return canvas_.finish();
  }

 private:
  static double figure_scale(const DocumentFigure& figure) {
    const double room_px = kBottom_px - kMargin_px - 80.0;  // minus the space of its heading
    return std::min({1.0, kWidth_px / figure.width_px, room_px / figure.height_px});
  }

  void need(double height_px) {
    if (y_px_ + height_px > kBottom_px) next_page();
  }

  void next_page() {
    draw_page_number();
    canvas_.next_page();
    ++page_;
    y_px_ = kMargin_px + 10.0;
  }

  void draw_page_number() {
    canvas_.text({kMargin_px, kPageHeight_px - 28.0}, document_.title, {9.0, kSoft});
    canvas_.text({kPageWidth_px - kMargin_px, kPageHeight_px - 28.0},
                 document_.page_word + " " + std::to_string(page_), {9.0, kSoft, TextAnchor::kEnd});
  }

  static bool is_text(const DocumentTable& table, std::size_t column) {
    return column == 0 ||
           std::count(table.text_columns.begin(), table.text_columns.end(), column) > 0;
  }

  /// Column widths by the longest cells; if the sum is too large, the widest column is reduced and
  /// its texts are broken into several lines.
  static std::vector<double> column_widths(const DocumentTable& table) {
    std::vector<double> widths_px(table.head.size(), 0.0);
    const auto take = [&](const std::vector<std::string>& cells, bool is_bold) {
      for (std::size_t c = 0; c < std::min(cells.size(), widths_px.size()); ++c) {
        widths_px[c] = std::max(widths_px[c], text_width_px(cells[c], kTableText_px, is_bold));
      }
    };
    take(table.head, true);
    for (const auto& row : table.rows) take(row, false);
    double sum_px = 0.0;
    for (double& width_px : widths_px) sum_px += width_px += kCellGap_px;
    for (int round = 0; sum_px > kWidth_px && round < 100; ++round) {
      const auto widest = std::max_element(widths_px.begin(), widths_px.end());
      const double less_px = std::min(*widest * 0.1, sum_px - kWidth_px);
      *widest -= less_px;
      sum_px -= less_px;
    }
    if (sum_px < kWidth_px && !widths_px.empty()) {
      for (double& width_px : widths_px) {
        width_px += (kWidth_px - sum_px) / static_cast<double>(widths_px.size());
      }
    }
    return widths_px;
  }

  static double num_lines(const DocumentTable&, const std::vector<std::string>& cells,
                          const std::vector<double>& widths_px) {
    std::size_t most = 1;
    for (std::size_t c = 0; c < std::min(cells.size(), widths_px.size()); ++c) {
      most = std::max(most, lines_of(cells[c], widths_px[c] - kCellGap_px, kTableText_px).size());
    }
    return static_cast<double>(most);
  }

  void draw_row(const DocumentTable& table, const std::vector<std::string>& cells,
                const std::vector<double>& widths_px, bool is_bold) {
    double x_px = kMargin_px;
    for (std::size_t c = 0; c < std::min(cells.size(), widths_px.size()); ++c) {
      const bool left = is_text(table, c);
      double line_px = y_px_;
      for (const std::string& line :
           lines_of(cells[c], widths_px[c] - kCellGap_px, kTableText_px)) {
        canvas_.text({left ? x_px : x_px + widths_px[c] - kCellGap_px, line_px}, line,
                     {kTableText_px, kInk, left ? TextAnchor::kStart : TextAnchor::kEnd, is_bold});
        line_px += kRow_px;
      }
      x_px += widths_px[c];
    }
    y_px_ += kRow_px * num_lines(table, cells, widths_px);
    canvas_.line({kMargin_px, y_px_ - 11.5}, {kMargin_px + kWidth_px, y_px_ - 11.5}, kRule,
                 is_bold ? 1.0 : 0.5);
  }

  const Document& document_;
  Canvas canvas_;
  double y_px_ = 0.0;
  int page_ = 1;
};

}  // namespace

std::string document_pdf(const Document& document) {
  PdfWriter writer(document);
  for (std::size_t i = 0; i < document.parts.size(); ++i) {
    if (std::holds_alternative<DocumentHeading>(document.parts[i])) {
      writer.begin_section(i + 1 < document.parts.size() ? &document.parts[i + 1] : nullptr);
    }
    std::visit(writer, document.parts[i]);
  }
  return writer.finish();
}

}  // namespace orchard::io
