// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/map_figure.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "io/figure/plot_axes.hpp"
#include "mapping/extent/extent.hpp"
#include "mapping/kind.hpp"

namespace orchard::io {
namespace {

using mapping::Kind;
using mapping::KindCounts;
using mapping::Landmark;

struct Style {
  Colour fill, stroke;
};

/// The style of a kind; trunks look like trees where they count like trees.
Style style_of(Kind kind, const KindCounts& kinds) {
  if (kinds.counts(kind)) return {kTreeColour, kTreeInk};
  if (kind == Kind::kTrunk) return {kTrunkColour, kTrunkInk};
  if (kind == Kind::kObject) return {kObjectColour, kObjectInk};
  return {kUnseenColour, kUnseenInk};
}

/// For areas, which would outshine the signs.
Colour pale(Colour colour) {
  const auto mixed = [](int value) { return static_cast<std::uint8_t>((value + 2 * 255) / 3); };
  return {mixed(colour.r), mixed(colour.g), mixed(colour.b)};
}

/// Sizes of signs and texts, depending on the number of landmarks.
struct Sizes {
  explicit Sizes(std::size_t num_landmarks) {
    if (num_landmarks <= 100) return;
    radius_px = 3.0;
    text_px = 10.0;  // 7.5 points on paper
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
    if (points.size() > 1) canvas.polyline(points, kRowColour, 1.5);
  }
}

/// Draws the navigation graph: aisles and headlands.
void draw_graph(const MapFrame& frame, const mapping::NavigationGraph& graph, Canvas& canvas) {
  for (const mapping::NavigationEdge& edge : graph.edges) {
    std::vector<PixelPoint> points;
    for (const Eigen::Vector2d& p : edge.line_map) points.push_back(frame.at(p.x(), p.y()));
    canvas.polyline(points, kAisleColour, 1.0);
  }
  for (const mapping::NavigationNode& node : graph.nodes) {
    canvas.circle(frame.at(node.p_map.x(), node.p_map.y()), 2.0, kAisleColour, kAisleColour);
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
    return canvas.polygon(border, pale(style.fill), style.stroke);
  }
  const PixelPoint p = frame.at(l.x_m, l.y_m);
  const double r = radius_px(frame, l, sizes);
  const bool is_area = l.label == detection::Label::kObject && r > sizes.radius_px;
  canvas.circle(p, r, is_area ? pale(style.fill) : style.fill, style.stroke);
  placement.take({p.x - r, p.y - r, p.x + r, p.y + r});
}

/// What is written at a landmark: the number in its row, else its id.
std::string number_text(const Landmark& l) {
  return l.position > 0 ? std::to_string(l.position) : "#" + std::to_string(l.id);
}

std::vector<NumberLabel> numbers_of(const MapFrame& frame, const std::vector<Landmark>& landmarks,
                                    const Sizes& sizes) {
  const KindCounts kinds(landmarks);
  std::vector<NumberLabel> labels;
  for (const Landmark& l : landmarks) {
    const Kind kind = mapping::kind_of(l);
    if (kind == Kind::kUnseen) continue;
    labels.push_back({frame.at(l.x_m, l.y_m), radius_px(frame, l, sizes),
                      l.position > 0 ? l.position : l.id, number_text(l),
                      style_of(kind, kinds).stroke});
  }
  return labels;
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
  if (has_ways) items.push_back(line_item("aisles", kAisleColour));
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
  const KindCounts kinds(landmarks);
  const MapFrame frame(points, legend_of(kinds, !graph.edges.empty()), heading,
                       format == FigureFormat::kPdf ? print_size(points) : PlotSizeMax{});
  const Sizes sizes(landmarks.size());
  Canvas canvas(format, frame.width_px(), frame.height_px());
  canvas.set_day(heading.day);
  frame.draw(canvas);
  LabelPlacement placement(frame.box());
  canvas.signs(landmarks.size(), sizes.radius_px, frame.box(), [&] {
    draw_graph(frame, graph, canvas);
    draw_row_lines(frame, rows, canvas);
    frame.draw_path(trajectory, canvas);
    for (const Kind kind : {Kind::kUnseen, Kind::kObject, Kind::kTrunk, Kind::kTree}) {
      for (const Landmark& l : landmarks) {
        if (mapping::kind_of(l) != kind) continue;
        draw_landmark(frame, l, style_of(kind, kinds), sizes, placement, canvas);
      }
    }
  });
  for (const mapping::Row& row : rows) {
    if (row.places.size() < 2) continue;
    draw_row_name(frame.at(row.places[0].p_map.x(), row.places[0].p_map.y()),
                  frame.at(row.places[1].p_map.x(), row.places[1].p_map.y()),
                  mapping::row_name(row_names, row.number, "R"), kRowInk, placement, canvas);
  }
  draw_numbers(numbers_of(frame, landmarks, sizes), sizes.text_px, placement, canvas);
  return canvas.finish();
}

}  // namespace orchard::io
