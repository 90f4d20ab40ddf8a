// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/overlay_figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "io/file_error.hpp"

namespace orchard::io {
namespace {

constexpr int kWidthWanted_px = 1280;
constexpr int kRow_px = 26;
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontScale = 0.55;
const cv::Scalar kWhite(255, 255, 255), kGrey(170, 170, 170), kBlack(0, 0, 0);
const cv::Scalar kTree(60, 220, 60), kObject(60, 60, 240), kUnseen(60, 200, 250);
const cv::Scalar kLine(255, 255, 0), kLineNotJudged(150, 150, 0);

/// Red at half a metre to blue at 6 m.
cv::Scalar colour_of_range(double range_m) {
  const double share = std::clamp((range_m - 0.5) / 5.5, 0.0, 1.0);
  const cv::Mat hsv(1, 1, CV_8UC3, cv::Scalar(std::round(120.0 * share), 255, 255));
  cv::Mat bgr;
  cv::cvtColor(hsv, bgr, cv::COLOR_HSV2BGR);
  const auto& pixel = bgr.at<cv::Vec3b>(0, 0);
  return {static_cast<double>(pixel[0]), static_cast<double>(pixel[1]),
          static_cast<double>(pixel[2])};
}

cv::Scalar colour_of(detection::Label label) {
  if (label == detection::Label::kTree) return kTree;
  return label == detection::Label::kObject ? kObject : kUnseen;
}

const char* name_of(detection::Label label) {
  if (label == detection::Label::kTree) return "TREE";
  return label == detection::Label::kObject ? "OBJECT" : "UNSEEN";
}

std::string decimals(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

/// Draws in picture coordinates on the enlarged picture.
class Sheet {
 public:
  explicit Sheet(const OverlayContent& content)
      : scale_(std::max(1, static_cast<int>(std::lround(1.0 * kWidthWanted_px /
                                                        content.picture.area.width_px)))) {
    const vision::PixelRect& area = content.picture.area;
    const cv::Mat picture(area.height_px, area.width_px, CV_8UC3,
                          const_cast<std::uint8_t*>(content.picture.bgr.data()));
    cv::Mat large;
    cv::resize(picture, large, {}, scale_, scale_, cv::INTER_NEAREST);
    const int rows = static_cast<int>(content.candidates.size()) + 2;
    const int width_px = std::max(large.cols, kWidthWanted_px);
    sheet_ = cv::Mat(large.rows + rows * kRow_px + 12, width_px, CV_8UC3, kBlack);
    large.copyTo(sheet_(cv::Rect(0, 0, large.cols, large.rows)));
    picture_height_px_ = large.rows;
  }

  void dot(double x_px, double y_px, const cv::Scalar& colour) {
    cv::circle(sheet_, at(x_px, y_px), std::max(2, scale_ / 2 + 1), colour, cv::FILLED,
               cv::LINE_AA);
  }
  void box(const vision::PixelRect& r, const cv::Scalar& colour, int thickness) {
    cv::rectangle(
        sheet_,
        cv::Rect(r.x_px * scale_, r.y_px * scale_, r.width_px * scale_, r.height_px * scale_),
        colour, thickness);
  }
  void line(double x0_px, double y0_px, double x1_px, double y1_px, const cv::Scalar& colour,
            int thickness) {
    cv::line(sheet_, at(x0_px, y0_px), at(x1_px, y1_px), colour, thickness, cv::LINE_AA);
  }
  void label(double x_px, double y_px, const std::string& text, const cv::Scalar& colour) {
    write(at(x_px, y_px) + cv::Point(-6, -6), text, colour, 0.7);
  }
  /// Row 0 is the title's, row 1 the heads'.
  void cell(int row, int x_px, const std::string& text, const cv::Scalar& colour) {
    write({x_px, picture_height_px_ + (row + 1) * kRow_px}, text, colour, kFontScale);
  }
  std::string png() const {
    std::vector<std::uint8_t> bytes;
    if (!cv::imencode(".png", sheet_, bytes)) throw FileError("overlay: OpenCV cannot encode it");
    return {bytes.begin(), bytes.end()};
  }

 private:
  /// The middle of a pixel.
  cv::Point at(double x_px, double y_px) const {
    return {static_cast<int>(std::lround((x_px + 0.5) * scale_)),
            static_cast<int>(std::lround((y_px + 0.5) * scale_))};
  }
  void write(cv::Point position, const std::string& text, const cv::Scalar& colour, double size) {
    cv::putText(sheet_, text, position, kFont, size, kBlack, 4, cv::LINE_AA);
    cv::putText(sheet_, text, position, kFont, size, colour, 1, cv::LINE_AA);
  }

  int scale_;
  int picture_height_px_ = 0;
  cv::Mat sheet_;
};

void draw_edge(Sheet& sheet, const vision::EdgeLine& edge, const vision::PixelRect& window,
               double expected_x_px, bool judged) {
  sheet.box(window, kGrey, 1);
  const double top = window.y_px, bottom = window.y_px + window.height_px - 1.0;
  sheet.line(expected_x_px, top - 2.0, expected_x_px, top, kWhite, 2);
  sheet.line(expected_x_px, bottom, expected_x_px, bottom + 2.0, kWhite, 2);
  if (!edge.found) return;
  const double lean = std::tan(edge.tilt_rad) * 0.5 * (bottom - top);
  sheet.line(edge.x_px - lean, top, edge.x_px + lean, bottom, judged ? kLine : kLineNotJudged, 2);
}

/// What the table holds of a candidate, by column.
constexpr std::array<const char*, 13> kHeads{"",       "label", "range",  "width",    "laser",
                                             "colour", "left",  "right",  "parallel", "edges",
                                             "vision", "tree",  "p(tree)"};
constexpr std::array<int, 13> kColumns_px{10,  50,  150, 240, 335, 425, 515,
                                          605, 695, 810, 900, 990, 1080};

std::array<std::string, 13> cells_of(const OverlayCandidate& c, int number) {
  const detection::Detection& d = c.detection;
  const auto of_edges = [&c](float roc) {
    return c.edges_judged ? decimals(roc, 2) : std::string("-");
  };
  const bool has_probability = d.probability_tree > 0.0f || d.probability_object > 0.0f;
  return {std::to_string(number),
          name_of(d.label),
          decimals(d.range_m, 2) + " m",
          decimals(1e3 * d.width_m, 0) + " mm",
          decimals(d.roc_laser, 2),
          decimals(d.roc_colour, 2),
          of_edges(d.roc_left_edge),
          of_edges(d.roc_right_edge),
          of_edges(d.roc_parallel),
          of_edges(d.roc_edges),
          decimals(d.roc_vision, 2),
          decimals(d.roc_tree, 2),
          has_probability ? decimals(d.probability_tree, 2) : "-"};
}

}  // namespace

std::string overlay_png(const OverlayContent& content) {
  Sheet sheet(content);
  for (const OverlayPoint& p : content.points)
    sheet.dot(p.x_px, p.y_px, colour_of_range(p.range_m));
  sheet.cell(0, kColumns_px[0], content.title, kWhite);
  for (std::size_t i = 0; i < kHeads.size(); ++i) sheet.cell(1, kColumns_px[i], kHeads[i], kGrey);
  int number = 0;
  for (const OverlayCandidate& c : content.candidates) {
    ++number;
    draw_edge(sheet, c.left, c.view.left_edge, c.view.left_x_px, c.edges_judged);
    draw_edge(sheet, c.right, c.view.right_edge, c.view.right_x_px, c.edges_judged);
    const cv::Scalar colour = colour_of(c.detection.label);
    sheet.box(c.view.centre, kWhite, 1);
    const double top = std::min(c.view.centre.y_px, c.view.left_edge.y_px);
    sheet.label(0.5 * (c.view.left_x_px + c.view.right_x_px), top - 3.0, std::to_string(number),
                colour);
    const auto cells = cells_of(c, number);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      sheet.cell(number + 1, kColumns_px[i], cells[i], i < 2 ? colour : kWhite);
    }
  }
  return sheet.png();
}

}  // namespace orchard::io
