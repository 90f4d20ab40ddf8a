// SPDX-License-Identifier: BSD-3-Clause
#include "io/map_figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "io/canvas.hpp"
#include "io/fixed_text.hpp"

namespace orchard::io {
namespace {

using detection::Label;
using mapping::Landmark;

constexpr double kPlotWidthPx = 1100.0;
constexpr double kPlotHeightPx = 800.0;
constexpr double kPlotMinPx = 220.0;
constexpr double kLeftPx = 70.0, kRightPx = 30.0, kTopPx = 50.0, kBottomPx = 60.0;
constexpr double kMinTickPx = 60.0;
constexpr double kAxisTextPx = 14.0;

constexpr Colour kBlack{30, 30, 30}, kGrid{228, 228, 228}, kPath{60, 110, 200}, kRow{170, 205, 170},
    kRowText{90, 140, 90};

struct Style {
  Colour fill, stroke;
};

Style style_of(Label label) {
  switch (label) {
    case Label::kTree:
      return {{70, 180, 80}, {20, 95, 30}};
    case Label::kObject:
      return {{225, 70, 60}, {130, 20, 15}};
    case Label::kUnseen:
      break;
  }
  return {{205, 205, 205}, {140, 140, 140}};
}

struct Box {
  double x0, y0, x1, y1;
  bool overlaps(const Box& other) const {
    return x0 < other.x1 && other.x0 < x1 && y0 < other.y1 && other.y0 < y1;
  }
};

/// Where metres lie in the picture.
class Frame {
 public:
  Frame(const std::vector<Landmark>& landmarks, const std::vector<pose::PoseEstimate>& path) {
    for (const Landmark& l : landmarks) include(l.x_m, l.y_m);
    for (const pose::PoseEstimate& p : path) include(p.x_m, p.y_m);
    if (x0_ > x1_) x0_ = y0_ = -1.0, x1_ = y1_ = 1.0;
    const double margin_m = std::max(0.3, 0.04 * std::max(x1_ - x0_, y1_ - y0_));
    x0_ -= margin_m, y0_ -= margin_m, x1_ += margin_m, y1_ += margin_m;
    px_per_m_ = std::min(kPlotWidthPx / (x1_ - x0_), kPlotHeightPx / (y1_ - y0_));
    widen(x0_, x1_);
    widen(y0_, y1_);
  }

  PixelPoint at(double x_m, double y_m) const {
    return {kLeftPx + (x_m - x0_) * px_per_m_, kTopPx + (y1_ - y_m) * px_per_m_};
  }
  Box plot() const {
    const PixelPoint low = at(x0_, y0_), high = at(x1_, y1_);
    return {low.x, high.y, high.x, low.y};
  }
  double px_per_m() const { return px_per_m_; }
  double x0() const { return x0_; }
  double x1() const { return x1_; }
  double y0() const { return y0_; }
  double y1() const { return y1_; }

 private:
  void include(double x, double y) {
    if (!std::isfinite(x) || !std::isfinite(y)) return;
    x0_ = std::min(x0_, x), x1_ = std::max(x1_, x);
    y0_ = std::min(y0_, y), y1_ = std::max(y1_, y);
  }
  /// A map of one row alone would be a strip too thin for axes and numbers.
  void widen(double& lo, double& hi) const {
    const double missing_m = kPlotMinPx / px_per_m_ - (hi - lo);
    if (missing_m > 0.0) lo -= 0.5 * missing_m, hi += 0.5 * missing_m;
  }

  double x0_ = 1e300, y0_ = 1e300, x1_ = -1e300, y1_ = -1e300;
  double px_per_m_ = 1.0;
};

/// 1, 2 or 5 times a power of ten.
double tick_step_m(double px_per_m) {
  const double least_m = kMinTickPx / px_per_m;
  const double power = std::pow(10.0, std::floor(std::log10(least_m)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= least_m) return factor * power;
  }
  return 10.0 * power;
}

void draw_axes(const Frame& frame, Canvas& canvas) {
  const Box plot = frame.plot();
  const double step = tick_step_m(frame.px_per_m());
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  for (double k = std::ceil(frame.x0() / step); k * step <= frame.x1(); k += 1.0) {
    const double x = frame.at(k * step, 0.0).x;
    canvas.line({x, plot.y0}, {x, plot.y1}, kGrid, 1.0);
    canvas.line({x, plot.y1}, {x, plot.y1 + 5.0}, kBlack, 1.0);
    canvas.text({x, plot.y1 + 20.0}, fixed_text(k * step, decimals), kAxisTextPx, kBlack,
                TextAnchor::kMiddle);
  }
  for (double k = std::ceil(frame.y0() / step); k * step <= frame.y1(); k += 1.0) {
    const double y = frame.at(0.0, k * step).y;
    canvas.line({plot.x0, y}, {plot.x1, y}, kGrid, 1.0);
    canvas.line({plot.x0 - 5.0, y}, {plot.x0, y}, kBlack, 1.0);
    canvas.text({plot.x0 - 9.0, y + 5.0}, fixed_text(k * step, decimals), kAxisTextPx, kBlack,
                TextAnchor::kEnd);
  }
  canvas.polyline({{plot.x0, plot.y0},
                   {plot.x1, plot.y0},
                   {plot.x1, plot.y1},
                   {plot.x0, plot.y1},
                   {plot.x0, plot.y0}},
                  kBlack, 1.0);
  canvas.text({0.5 * (plot.x0 + plot.x1), plot.y1 + 44.0}, "x (m)", kAxisTextPx, kBlack,
              TextAnchor::kMiddle);
  canvas.text({plot.x0 - 9.0, plot.y0 - 18.0}, "y (m)", kAxisTextPx, kBlack, TextAnchor::kEnd);
}

void draw_path(const Frame& frame, const std::vector<pose::PoseEstimate>& path, Canvas& canvas) {
  constexpr double kLeastStepPx = 0.75;
  std::vector<PixelPoint> points;
  for (const pose::PoseEstimate& pose : path) {
    const PixelPoint p = frame.at(pose.x_m, pose.y_m);
    if (!points.empty() &&
        std::hypot(p.x - points.back().x, p.y - points.back().y) < kLeastStepPx) {
      continue;
    }
    points.push_back(p);
  }
  if (points.size() > 1) canvas.polyline(points, kPath, 1.5);
  for (const PixelPoint& p : points) {
    if (points.size() <= 50) canvas.circle(p, 2.0, kPath, kPath);  // where a stepped robot stood
  }
}

/// A line per row, and its number before its first place.
void draw_rows(const Frame& frame, const std::vector<mapping::Row>& rows, Canvas& canvas) {
  for (const mapping::Row& row : rows) {
    std::vector<PixelPoint> points;
    for (const mapping::RowPlace& place : row.places) {
      points.push_back(frame.at(place.p_map.x(), place.p_map.y()));
    }
    if (points.size() < 2) continue;
    canvas.polyline(points, kRow, 1.5);
    const double dx = points[0].x - points[1].x, dy = points[0].y - points[1].y;
    const double length = std::max(1e-9, std::hypot(dx, dy));
    canvas.text({points[0].x + 18.0 * dx / length, points[0].y + 18.0 * dy / length + 5.0},
                "R" + std::to_string(row.number), kAxisTextPx, kRowText, TextAnchor::kMiddle);
  }
}

double radius_px(const Frame& frame, const Landmark& l, double least_px) {
  return std::max(least_px, 0.5 * l.width_m * frame.px_per_m());
}

void draw_numbers(const Frame& frame, const std::vector<Landmark>& landmarks, double least_px,
                  double text_px, Canvas& canvas) {
  std::vector<Box> taken;
  for (const Landmark& l : landmarks) {
    const PixelPoint p = frame.at(l.x_m, l.y_m);
    const double r = radius_px(frame, l, least_px);
    taken.push_back({p.x - r, p.y - r, p.x + r, p.y + r});
  }
  const Box plot = frame.plot();
  constexpr std::array<std::array<double, 2>, 8> kSides = {
      {{1, 0}, {-1, 0}, {0, -1}, {0, 1}, {1, -1}, {-1, -1}, {1, 1}, {-1, 1}}};
  for (const Landmark& l : landmarks) {
    if (l.label == Label::kUnseen) continue;
    const std::string number = std::to_string(l.id);
    const double half_width = 0.31 * text_px * static_cast<double>(number.size());
    const double half_height = 0.42 * text_px;
    const PixelPoint p = frame.at(l.x_m, l.y_m);
    const double r = radius_px(frame, l, least_px);
    for (std::size_t k = 0; k < 2 * kSides.size(); ++k) {
      const auto& side = kSides[k % kSides.size()];
      const double gap = r + (k < kSides.size() ? 3.0 : 8.0);
      const PixelPoint c{p.x + side[0] * (gap + half_width), p.y + side[1] * (gap + half_height)};
      const Box box{c.x - half_width, c.y - half_height, c.x + half_width, c.y + half_height};
      const bool inside =
          box.x0 >= plot.x0 && box.x1 <= plot.x1 && box.y0 >= plot.y0 && box.y1 <= plot.y1;
      if (!inside || std::any_of(taken.begin(), taken.end(),
                                 [&box](const Box& other) { return box.overlaps(other); })) {
        continue;
      }
      canvas.text({c.x, c.y + 0.36 * text_px}, number, text_px, style_of(l.label).stroke,
                  TextAnchor::kMiddle);
      taken.push_back(box);
      break;
    }
  }
}

void draw_legend(const std::vector<Landmark>& landmarks, Canvas& canvas) {
  PixelPoint at{kLeftPx + 10.0, 22.0};
  for (const Label label : {Label::kTree, Label::kObject, Label::kUnseen}) {
    const auto count = std::count_if(landmarks.begin(), landmarks.end(),
                                     [label](const Landmark& l) { return l.label == label; });
    if (count == 0 && label == Label::kUnseen) continue;
    const char* names[] = {"unseen", "trees", "objects"};
    canvas.circle({at.x, at.y - 5.0}, 6.0, style_of(label).fill, style_of(label).stroke);
    const std::string item = std::to_string(count) + " " + names[static_cast<int>(label)];
    canvas.text({at.x + 12.0, at.y}, item, kAxisTextPx, kBlack, TextAnchor::kStart);
    at.x += 45.0 + 8.5 * static_cast<double>(item.size());
  }
  canvas.line({at.x - 8.0, at.y - 5.0}, {at.x + 10.0, at.y - 5.0}, kPath, 2.0);
  canvas.text({at.x + 15.0, at.y}, "path", kAxisTextPx, kBlack, TextAnchor::kStart);
}

void draw(const Frame& frame, const std::vector<Landmark>& landmarks,
          const std::vector<pose::PoseEstimate>& path, const std::vector<mapping::Row>& rows,
          Canvas& canvas) {
  const bool crowded = landmarks.size() > 100;
  const double least_px = crowded ? 3.0 : 6.0;
  const double text_px = landmarks.size() > 300 ? 9.0 : crowded ? 10.0 : 14.0;
  draw_axes(frame, canvas);
  draw_rows(frame, rows, canvas);
  draw_path(frame, path, canvas);
  for (const Label label : {Label::kUnseen, Label::kObject, Label::kTree}) {  // trees on top
    for (const Landmark& l : landmarks) {
      if (l.label != label) continue;
      canvas.circle(frame.at(l.x_m, l.y_m), radius_px(frame, l, least_px), style_of(label).fill,
                    style_of(label).stroke);
    }
  }
  draw_numbers(frame, landmarks, least_px, text_px, canvas);
  draw_legend(landmarks, canvas);
}

}  // namespace

MapFigure draw_map(const std::vector<Landmark>& landmarks,
                   const std::vector<pose::PoseEstimate>& trajectory,
                   const std::vector<mapping::Row>& rows) {
  const Frame frame(landmarks, trajectory);
  const Box plot = frame.plot();
  const int width_px = std::max(560, static_cast<int>(std::ceil(plot.x1 + kRightPx)));
  const int height_px = static_cast<int>(std::ceil(plot.y1 + kBottomPx));
  const auto svg = make_svg_canvas(width_px, height_px);
  const auto png = make_png_canvas(width_px, height_px);
  for (Canvas* canvas : {svg.get(), png.get()}) {
    draw(frame, landmarks, trajectory, rows, *canvas);
  }
  return {svg->bytes(), png->bytes()};
}

}  // namespace orchard::io
