// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/map_figure.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "io/figure/plot_axes.hpp"
#include "mapping/extent/extent.hpp"
#include "mapping/kind.hpp"

namespace orchard::io {
namespace {

using mapping::Kind;
using mapping::KindCounts;
using mapping::Landmark;

constexpr Colour kRow{170, 205, 170}, kRowText{90, 140, 90}, kWay{225, 190, 120};

struct Style {
  Colour fill, stroke;
};

/// The style of a kind; trunks look like trees where they count like trees.
Style style_of(Kind kind, const KindCounts& kinds) {
  if (kinds.counts(kind)) return {{70, 180, 80}, {20, 95, 30}};
  if (kind == Kind::kTrunk) return {{200, 225, 180}, {120, 150, 95}};
  if (kind == Kind::kObject) return {{225, 70, 60}, {130, 20, 15}};
  return {{205, 205, 205}, {140, 140, 140}};
}

/// Sizes of signs and texts, depending on the number of landmarks.
struct Sizes {
  Sizes(std::size_t num_landmarks, bool is_print) {
    if (num_landmarks <= 100) return;
    radius_px = 3.0;
    text_px = is_print ? 8.0 : 10.0;
  }
  double radius_px = 6.0;  ///< minimum
  double text_px = 14.0;
};

/// A3 in landscape or portrait format, depending on the map's extent.
PlotSizeMax print_size(const std::vector<Eigen::Vector2d>& points_map) {
  constexpr double kLong_px = 1480.0, kShort_px = 960.0;
  Eigen::AlignedBox2d extent;
  for (const Eigen::Vector2d& p : points_map) {
    if (p.allFinite()) extent.extend(p);
  }
  const bool is_wide = extent.isEmpty() || extent.sizes().x() > extent.sizes().y();
  return is_wide ? PlotSizeMax{kLong_px, kShort_px} : PlotSizeMax{kShort_px, kLong_px - 60.0};
}

void draw_row_lines(const MapFrame& frame, const std::vector<mapping::Row>& rows, Canvas& canvas) {
  for (const mapping::Row& row : rows) {
    std::vector<PixelPoint> points;
    for (const mapping::RowSlot& place : row.places) {
      points.push_back(frame.at(place.p_map.x(), place.p_map.y()));
    }
    if (points.size() > 1) canvas.polyline(points, kRow, 1.5);
  }
}

/// Draws the navigation graph: aisles and headlands.
void draw_graph(const MapFrame& frame, const mapping::NavigationGraph& graph, Canvas& canvas) {
  for (const mapping::NavigationEdge& edge : graph.edges) {
    std::vector<PixelPoint> points;
    for (const Eigen::Vector2d& p : edge.line_map) points.push_back(frame.at(p.x(), p.y()));
    canvas.polyline(points, kWay, 1.0);
  }
  for (const mapping::NavigationNode& node : graph.nodes) {
    canvas.circle(frame.at(node.p_map.x(), node.p_map.y()), 2.0, kWay, kWay);
  }
}

double radius_px(const MapFrame& frame, const Landmark& l, const Sizes& sizes) {
  return std::max(sizes.radius_px, 0.5 * l.width_m * frame.px_per_m());
}

/// Draws hedges and walls with their length, other landmarks as discs of a visible minimum size.
void draw_landmark(const MapFrame& frame, const Landmark& l, const Style& style, const Sizes& sizes,
                   LabelPlacement& placement, Canvas& canvas) {
  if (l.length_m > 0.0) {
    std::vector<PixelPoint> border;
    for (const Eigen::Vector2d& p : mapping::outline_of(l))
      border.push_back(frame.at(p.x(), p.y()));
    return canvas.polygon(border, style.fill, style.stroke);
  }
  const PixelPoint p = frame.at(l.x_m, l.y_m);
  const double r = radius_px(frame, l, sizes);
  canvas.circle(p, r, style.fill, style.stroke);
  placement.take({p.x - r, p.y - r, p.x + r, p.y + r});
}

/// Draws each row's name before its first tree.
void draw_row_names(const MapFrame& frame, const std::vector<mapping::Row>& rows,
                    const mapping::RowNames& names, LabelPlacement& placement, Canvas& canvas) {
  constexpr double kOut_px = 14.0;
  for (const mapping::Row& row : rows) {
    if (row.places.size() < 2) continue;
    const PixelPoint first = frame.at(row.places[0].p_map.x(), row.places[0].p_map.y());
    const PixelPoint second = frame.at(row.places[1].p_map.x(), row.places[1].p_map.y());
    const double dx = first.x - second.x, dy = first.y - second.y;
    const double fraction = kOut_px / std::max(1e-9, std::hypot(dx, dy));
    draw_label({first.x + fraction * dx, first.y + fraction * dy}, 0.0,
               mapping::row_name(names, row.number, "R"), kAxisTextPx, kRowText, placement,
               &canvas);
  }
}

/// Label steps (every n-th number); the first is used for which this fraction finds a free place.
constexpr std::array<std::int32_t, 12> kSteps{1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000};
constexpr double kPlacedFraction = 0.8;

/// What is written at a landmark: the number in its row, else its id.
std::string number_text(const Landmark& l) {
  return l.position > 0 ? std::to_string(l.position) : "#" + std::to_string(l.id);
}

/// Draws the labels of the numbers that are multiples of the step; returns whether nearly all fit.
bool draw_every(std::int32_t step, const MapFrame& frame, const std::vector<Landmark>& landmarks,
                const Sizes& sizes, LabelPlacement placement, Canvas* canvas) {
  const KindCounts kinds(landmarks);
  int num_wanted = 0, num_placed = 0;
  for (const Landmark& l : landmarks) {
    const Kind kind = mapping::kind_of(l);
    const std::int32_t number = l.position > 0 ? l.position : l.id;
    if (kind == Kind::kUnseen || number % step != 0) continue;
    ++num_wanted;
    num_placed += draw_label(frame.at(l.x_m, l.y_m), radius_px(frame, l, sizes), number_text(l),
                             sizes.text_px, style_of(kind, kinds).stroke, placement, canvas);
  }
  return num_placed >= kPlacedFraction * num_wanted;
}

void draw_numbers(const MapFrame& frame, const std::vector<Landmark>& landmarks, const Sizes& sizes,
                  const LabelPlacement& placement, Canvas& canvas) {
  std::size_t i = 0;
  while (i + 1 < kSteps.size() &&
         !draw_every(kSteps[i], frame, landmarks, sizes, placement, nullptr)) {
    ++i;
  }
  draw_every(kSteps[i], frame, landmarks, sizes, placement, &canvas);
}

std::vector<LegendItem> legend_of(const KindCounts& kinds, bool has_ways) {
  std::vector<LegendItem> items;
  for (const Kind kind : {Kind::kTree, Kind::kTrunk, Kind::kObject, Kind::kUnseen}) {
    if (kinds.of(kind) == 0) continue;
    items.push_back({std::to_string(kinds.of(kind)) + " " + kinds.name(kind),
                     [style = style_of(kind, kinds)](PixelPoint centre, Canvas& canvas) {
                       canvas.circle(centre, 6.0, style.fill, style.stroke);
                     }});
  }
  items.push_back(line_item("path", kPathColour));
  if (has_ways) items.push_back(line_item("aisles", kWay));
  return items;
}

}  // namespace

std::string map_figure(const std::vector<Landmark>& landmarks,
                       const std::vector<pose::PoseEstimate>& trajectory,
                       const std::vector<mapping::Row>& rows, const mapping::NavigationGraph& graph,
                       FigureFormat format, const MapHeading& heading,
                       const mapping::RowNames& row_names) {
  std::vector<Eigen::Vector2d> points;
  for (const Landmark& l : landmarks) {
    points.push_back({l.x_m, l.y_m});
    if (l.length_m == 0.0) continue;
    const std::vector<Eigen::Vector2d> border = mapping::outline_of(l);
    points.insert(points.end(), border.begin(), border.end());
  }
  for (const pose::PoseEstimate& p : trajectory) points.push_back({p.x_m, p.y_m});
  for (const mapping::NavigationNode& node : graph.nodes) points.push_back(node.p_map);
  for (const mapping::NavigationEdge& edge : graph.edges) {
    points.insert(points.end(), edge.line_map.begin(), edge.line_map.end());
  }
  const bool is_print = format == FigureFormat::kPdf;
  const KindCounts kinds(landmarks);
  const MapFrame frame(points, legend_of(kinds, !graph.edges.empty()), heading,
                       is_print ? print_size(points) : PlotSizeMax{});
  const Sizes sizes(landmarks.size(), is_print);
  Canvas canvas(format, frame.width_px(), frame.height_px());
  canvas.set_day(heading.day);
  frame.draw(canvas);
  draw_graph(frame, graph, canvas);
  draw_row_lines(frame, rows, canvas);
  frame.draw_path(trajectory, canvas);
  LabelPlacement placement(frame.box());
  for (const Kind kind : {Kind::kUnseen, Kind::kObject, Kind::kTrunk, Kind::kTree}) {
    for (const Landmark& l : landmarks) {
      if (mapping::kind_of(l) != kind) continue;
      draw_landmark(frame, l, style_of(kind, kinds), sizes, placement, canvas);
    }
  }
  draw_row_names(frame, rows, row_names, placement, canvas);
  draw_numbers(frame, landmarks, sizes, placement, canvas);
  return canvas.finish();
}

}  // namespace orchard::io
