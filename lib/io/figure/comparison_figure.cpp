// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/comparison_figure.hpp"

#include <cstddef>

#include "io/figure/map_frame.hpp"
#include "io/figure/plot_axes.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

using mapping::Change;
using mapping::Landmark;
using mapping::MapChange;

constexpr Change kAllChanges[] = {Change::kMissing, Change::kNew,     Change::kMoved,
                                  Change::kGrown,   Change::kThinner, Change::kUnchanged,
                                  Change::kNotSeen};

/// In the order of Change.
constexpr Colour kColours[] = {{190, 190, 190}, {225, 60, 50},   {50, 170, 70},  {50, 100, 220},
                               {150, 80, 190},  {205, 160, 225}, {245, 245, 245}};

Colour colour_of(Change change) { return kColours[static_cast<std::size_t>(change)]; }

constexpr Colour kEdge{120, 120, 120};

/// The signs also differ in shape: missing is crossed out, grown has an outer ring, thinner an
/// inner one.
void draw_sign(Change change, const PixelPoint& at, Canvas& canvas) {
  constexpr double kRadiusPx = 5.5, kRingPx = 8.5, kCrossPx = 4.0;
  const Colour colour = colour_of(change);
  switch (change) {
    case Change::kUnchanged:
    case Change::kNotSeen:
      canvas.circle(at, 3.0, colour, kEdge);
      return;
    case Change::kMissing:
      canvas.circle(at, kRadiusPx + 1.0, kWhite, colour);
      for (const double rise : {-kCrossPx, kCrossPx}) {
        canvas.line({at.x - kCrossPx, at.y - rise}, {at.x + kCrossPx, at.y + rise}, colour, 2.0);
      }
      return;
    case Change::kGrown:
      canvas.circle(at, kRingPx, kWhite, colour);
      break;
    case Change::kThinner:
      canvas.circle(at, kRadiusPx, colour, kBlack);
      canvas.circle(at, 2.5, kWhite, kBlack);
      return;
    case Change::kNew:
    case Change::kMoved:
      break;
  }
  canvas.circle(at, kRadiusPx, colour, kBlack);
}

/// Caption: the id in the earlier map (or "new" and the later id) and the amount of the change.
std::string caption(const ComparisonContent& content, const MapChange& c) {
  const std::string id = c.a < 0
                             ? "new " + std::to_string(content.b[static_cast<std::size_t>(c.b)].id)
                             : std::to_string(content.a[static_cast<std::size_t>(c.a)].id);
  if (c.change == Change::kMoved) return id + ": " + fixed_text(c.moved_m, 1) + " m";
  if (c.change != Change::kGrown && c.change != Change::kThinner) return id;
  return id + (c.width_change_m > 0.0 ? ": +" : ": ") + fixed_text(1e3 * c.width_change_m, 0) +
         " mm";
}

bool is_quiet(Change change) { return change == Change::kUnchanged || change == Change::kNotSeen; }

void draw_change(const MapFrame& frame, const ComparisonContent& content, const MapChange& c,
                 Canvas& canvas) {
  constexpr double kOldPlacePx = 4.0;
  const PixelPoint at = frame.at(c.p_a.x(), c.p_a.y());
  if (c.change == Change::kMoved) {
    const Landmark& before = content.a[static_cast<std::size_t>(c.a)];
    const PixelPoint from = frame.at(before.x_m, before.y_m);
    canvas.line(from, at, colour_of(c.change), 2.0);
    canvas.circle(from, kOldPlacePx, kWhite, colour_of(c.change));
  }
  draw_sign(c.change, at, canvas);
}

std::vector<LegendItem> legend_of(const mapping::MapComparison& comparison) {
  std::vector<LegendItem> items;
  for (const Change change : kAllChanges) {
    const int count = comparison.count(change);
    if (count == 0) continue;
    const std::string name = change == Change::kNotSeen ? "not seen" : mapping::change_text(change);
    items.push_back({std::to_string(count) + " " + name,
                     [change](PixelPoint at, Canvas& canvas) { draw_sign(change, at, canvas); }});
  }
  return items;
}

}  // namespace

std::string comparison_figure(const ComparisonContent& content, FigureFormat format) {
  constexpr double kSignPx = 9.0, kQuietSignPx = 3.0;
  const std::vector<MapChange>& changes = content.comparison.changes;
  std::vector<Eigen::Vector2d> points;
  for (const MapChange& c : changes) points.push_back(c.p_a);
  const MapFrame frame(points, legend_of(content.comparison));
  Canvas canvas(format, frame.width_px(), frame.height_px());
  frame.draw(canvas);
  LabelPlacement placement(frame.box());
  canvas.signs(changes.size(), kQuietSignPx, frame.box(), [&] {
    for (const bool quiet : {true, false}) {  // changed landmarks on top
      for (const MapChange& c : changes) {
        if (is_quiet(c.change) != quiet) continue;
        draw_change(frame, content, c, canvas);
        const PixelPoint at = frame.at(c.p_a.x(), c.p_a.y());
        const double radius = quiet ? kQuietSignPx : kSignPx;
        placement.take({at.x - radius, at.y - radius, at.x + radius, at.y + radius});
      }
    }
  });
  for (const MapChange& c : changes) {
    if (is_quiet(c.change)) continue;
    draw_label(frame.at(c.p_a.x(), c.p_a.y()), kSignPx, caption(content, c), 11.0, kBlack,
               placement, &canvas);
  }
  return canvas.finish();
}

}  // namespace orchard::io
