// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/map_figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "io/figure/canvas.hpp"
#include "io/figure/figure_frame.hpp"

namespace orchard::io {
namespace {

using detection::Label;
using mapping::Landmark;

constexpr Colour kBlack{30, 30, 30}, kRow{170, 205, 170}, kRowText{90, 140, 90},
    kWay{225, 190, 120};

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

/// A line per row, and its number before its first place.
void draw_rows(const FigureFrame& frame, const std::vector<mapping::Row>& rows, Canvas& canvas) {
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

/// Where a vehicle can go: between the rows and round their ends.
void draw_graph(const FigureFrame& frame, const mapping::NavigationGraph& graph, Canvas& canvas) {
  for (const mapping::NavigationEdge& edge : graph.edges) {
    std::vector<PixelPoint> points;
    for (const Eigen::Vector2d& p : edge.line_map) points.push_back(frame.at(p.x(), p.y()));
    canvas.polyline(points, kWay, 1.0);
  }
  for (const mapping::NavigationNode& node : graph.nodes) {
    canvas.circle(frame.at(node.p_map.x(), node.p_map.y()), 2.0, kWay, kWay);
  }
}

double radius_px(const FigureFrame& frame, const Landmark& l, double least_px) {
  return std::max(least_px, 0.5 * l.width_m * frame.px_per_m());
}

void draw_numbers(const FigureFrame& frame, const std::vector<Landmark>& landmarks, double least_px,
                  double text_px, Canvas& canvas) {
  std::vector<PixelBox> taken;
  for (const Landmark& l : landmarks) {
    const PixelPoint p = frame.at(l.x_m, l.y_m);
    const double r = radius_px(frame, l, least_px);
    taken.push_back({p.x - r, p.y - r, p.x + r, p.y + r});
  }
  const PixelBox plot = frame.plot();
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
      const PixelBox box{c.x - half_width, c.y - half_height, c.x + half_width, c.y + half_height};
      const bool inside =
          box.x0 >= plot.x0 && box.x1 <= plot.x1 && box.y0 >= plot.y0 && box.y1 <= plot.y1;
      if (!inside || std::any_of(taken.begin(), taken.end(),
                                 [&box](const PixelBox& other) { return box.overlaps(other); })) {
        continue;
      }
      canvas.text({c.x, c.y + 0.36 * text_px}, number, text_px, style_of(l.label).stroke,
                  TextAnchor::kMiddle);
      taken.push_back(box);
      break;
    }
  }
}

void draw_legend(const std::vector<Landmark>& landmarks, bool has_ways, PixelPoint at,
                 Canvas& canvas) {
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
  canvas.line({at.x - 8.0, at.y - 5.0}, {at.x + 10.0, at.y - 5.0}, kPathColour, 2.0);
  canvas.text({at.x + 15.0, at.y}, "path", kAxisTextPx, kBlack, TextAnchor::kStart);
  if (!has_ways) return;
  at.x += 70.0;
  canvas.line({at.x - 8.0, at.y - 5.0}, {at.x + 10.0, at.y - 5.0}, kWay, 2.0);
  canvas.text({at.x + 15.0, at.y}, "ways", kAxisTextPx, kBlack, TextAnchor::kStart);
}

void draw(const FigureFrame& frame, const std::vector<Landmark>& landmarks,
          const std::vector<pose::PoseEstimate>& path, const std::vector<mapping::Row>& rows,
          const mapping::NavigationGraph& graph, Canvas& canvas) {
  const bool crowded = landmarks.size() > 100;
  const double least_px = crowded ? 3.0 : 6.0;
  const double text_px = landmarks.size() > 300 ? 9.0 : crowded ? 10.0 : 14.0;
  frame.draw_axes(canvas);
  draw_graph(frame, graph, canvas);
  draw_rows(frame, rows, canvas);
  frame.draw_path(path, canvas);
  for (const Label label : {Label::kUnseen, Label::kObject, Label::kTree}) {  // trees on top
    for (const Landmark& l : landmarks) {
      if (l.label != label) continue;
      canvas.circle(frame.at(l.x_m, l.y_m), radius_px(frame, l, least_px), style_of(label).fill,
                    style_of(label).stroke);
    }
  }
  draw_numbers(frame, landmarks, least_px, text_px, canvas);
  draw_legend(landmarks, !graph.edges.empty(), frame.legend(), canvas);
}

}  // namespace

MapFigure draw_map(const std::vector<Landmark>& landmarks,
                   const std::vector<pose::PoseEstimate>& trajectory,
                   const std::vector<mapping::Row>& rows, const mapping::NavigationGraph& graph) {
  std::vector<Eigen::Vector2d> points;
  for (const Landmark& l : landmarks) points.push_back({l.x_m, l.y_m});
  for (const pose::PoseEstimate& p : trajectory) points.push_back({p.x_m, p.y_m});
  for (const mapping::NavigationNode& node : graph.nodes) points.push_back(node.p_map);
  const FigureFrame frame(points);
  const auto svg = make_svg_canvas(frame.width_px(), frame.height_px());
  const auto png = make_png_canvas(frame.width_px(), frame.height_px());
  for (Canvas* canvas : {svg.get(), png.get()}) {
    draw(frame, landmarks, trajectory, rows, graph, *canvas);
  }
  return {svg->bytes(), png->bytes()};
}

}  // namespace orchard::io
