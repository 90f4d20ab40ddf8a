// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/overlay_figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "text/number_text.hpp"

namespace orchard::io {
namespace {

constexpr int kWidthWanted_px = 1280;
constexpr int kRow_px = 26;
constexpr double kCellText_px = 15.0, kNumberText_px = 18.0;
constexpr Colour kBackground{0, 0, 0}, kGrey{170, 170, 170};
constexpr Colour kTree{60, 220, 60}, kObject{240, 60, 60}, kUnseen{250, 200, 60};
constexpr Colour kLine{0, 255, 255}, kLineNotJudged{0, 150, 150};

/// Red at 0.5 m over yellow, green and cyan to blue at 6 m.
Colour colour_of_range(double range_m) {
  const double sixth = 4.0 * std::clamp((range_m - 0.5) / 5.5, 0.0, 1.0);
  const auto channel = [sixth](double centre) {  // full within a sixth of it, then decreasing
    const double value = std::clamp(2.0 - std::abs(sixth - centre), 0.0, 1.0);
    return static_cast<std::uint8_t>(std::lround(255.0 * value));
  };
  return {channel(0.0), channel(2.0), channel(4.0)};
}

Colour colour_of(detection::Label label) {
  if (label == detection::Label::kTree) return kTree;
  return label == detection::Label::kObject ? kObject : kUnseen;
}

const char* name_of(detection::Label label) {
  if (label == detection::Label::kTree) return "TREE";
  return label == detection::Label::kObject ? "OBJECT" : "UNSEEN";
}

/// Draws in image coordinates on the enlarged image, and in the rows of a table below it.
class Sheet {
 public:
  Sheet(const OverlayContent& content, FigureFormat format)
      : area_(content.picture.area),
        scale_(std::max(1, static_cast<int>(std::lround(1.0 * kWidthWanted_px / area_.width_px)))),
        canvas_(format, std::max(scale_ * area_.width_px, kWidthWanted_px),
                scale_ * area_.height_px +
                    (static_cast<int>(content.candidates.size()) + 2) * kRow_px + 12,
                kBackground) {
    canvas_.image({0.0, 0.0, 1.0 * scale_ * area_.width_px, 1.0 * scale_ * area_.height_px},
                  content.picture.bgr, area_.width_px, area_.height_px);
  }

  void dot(double x_px, double y_px, Colour colour) {
    canvas_.circle(at(x_px, y_px), std::max(2.0, 0.5 * scale_ + 1.0), colour, colour);
  }
  void box(const vision::PixelRect& r, Colour colour) {
    const double x0 = r.x_px * scale_ + 0.5, y0 = r.y_px * scale_ + 0.5;
    canvas_.rectangle({x0, y0, x0 + r.width_px * scale_ - 1, y0 + r.height_px * scale_ - 1}, {},
                      colour);
  }
  void line(double x0_px, double y0_px, double x1_px, double y1_px, Colour colour) {
    canvas_.line(at(x0_px, y0_px), at(x1_px, y1_px), colour, 2.0);
  }
  void label(double x_px, double y_px, const std::string& text, Colour colour) {
    PixelPoint position = at(x_px, y_px);
    position.y -= 6.0;
    write(position, text, {kNumberText_px, colour, TextAnchor::kMiddle});
  }
  /// Row 0 is the title, row 1 the table head.
  void cell(int row, int x_px, const std::string& text, Colour colour) {
    write({1.0 * x_px, 1.0 * (scale_ * area_.height_px + (row + 1) * kRow_px)}, text,
          {kCellText_px, colour});
  }
  std::string finish() { return canvas_.finish(); }

 private:
  /// The centre of a pixel.
  PixelPoint at(double x_px, double y_px) const {
    return {(x_px + 0.5) * scale_, (y_px + 0.5) * scale_};
  }
  void write(PixelPoint position, const std::string& text, TextStyle style) {
    style.halo_colour = kBackground;
    canvas_.text(position, text, style);
  }

  vision::PixelRect area_;
  int scale_;
  Canvas canvas_;
};

void draw_edge(Sheet& sheet, const vision::EdgeLine& edge, const vision::PixelRect& window,
               double expected_x_px, bool judged) {
  sheet.box(window, kGrey);
  const double top = window.y_px, bottom = window.y_px + window.height_px - 1.0;
  sheet.line(expected_x_px, top - 2.0, expected_x_px, top, kWhite);
  sheet.line(expected_x_px, bottom, expected_x_px, bottom + 2.0, kWhite);
  if (!edge.found) return;
  const double lean = std::tan(edge.tilt_rad) * 0.5 * (bottom - top);
  sheet.line(edge.x_px - lean, top, edge.x_px + lean, bottom, judged ? kLine : kLineNotJudged);
}

/// Columns of the table of candidates.
constexpr std::array<const char*, 13> kHeads{"",       "label", "range",  "width",    "laser",
                                             "colour", "left",  "right",  "parallel", "edges",
                                             "vision", "tree",  "p(tree)"};
constexpr std::array<int, 13> kColumns_px{10,  50,  150, 240, 335, 425, 515,
                                          605, 695, 810, 900, 990, 1080};

std::array<std::string, 13> cells_of(const OverlayCandidate& c, int number) {
  const detection::Detection& d = c.detection;
  const auto of_edges = [&c](float roc) {
    return c.edges_judged ? fixed_text(roc, 2) : std::string("-");
  };
  const bool has_probability = d.probability_tree > 0.0f || d.probability_object > 0.0f;
  return {std::to_string(number),
          name_of(d.label),
          fixed_text(d.range_m, 2) + " m",
          fixed_text(1e3 * d.width_m, 0) + " mm",
          fixed_text(d.roc_laser, 2),
          fixed_text(d.roc_colour, 2),
          of_edges(d.roc_left_edge),
          of_edges(d.roc_right_edge),
          of_edges(d.roc_parallel),
          of_edges(d.roc_edges),
          fixed_text(d.roc_vision, 2),
          fixed_text(d.roc_tree, 2),
          has_probability ? fixed_text(d.probability_tree, 2) : "-"};
}

}  // namespace

std::string overlay_figure(const OverlayContent& content, FigureFormat format) {
  Sheet sheet(content, format);
  for (const OverlayPoint& p : content.points)
    sheet.dot(p.x_px, p.y_px, colour_of_range(p.range_m));
  sheet.cell(0, kColumns_px[0], content.title, kWhite);
  for (std::size_t i = 0; i < kHeads.size(); ++i) sheet.cell(1, kColumns_px[i], kHeads[i], kGrey);
  int number = 0;
  for (const OverlayCandidate& c : content.candidates) {
    ++number;
    draw_edge(sheet, c.left, c.view.left_edge, c.view.left_x_px, c.edges_judged);
    draw_edge(sheet, c.right, c.view.right_edge, c.view.right_x_px, c.edges_judged);
    const Colour colour = colour_of(c.detection.label);
    sheet.box(c.view.centre, kWhite);
    const double top = std::min(c.view.centre.y_px, c.view.left_edge.y_px);
    sheet.label(0.5 * (c.view.left_x_px + c.view.right_x_px), top - 3.0, std::to_string(number),
                colour);
    const auto cells = cells_of(c, number);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      sheet.cell(number + 1, kColumns_px[i], cells[i], i < 2 ? colour : kWhite);
    }
  }
  return sheet.finish();
}

}  // namespace orchard::io
