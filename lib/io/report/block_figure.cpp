// SPDX-License-Identifier: BSD-3-Clause
#include "io/report/block_figure.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>

#include "io/figure/label_placement.hpp"
#include "io/figure/plot_axes.hpp"

namespace orchard::io {
namespace {

using mapping::Landmark;

constexpr Colour kTree{70, 150, 80}, kTreeBorder{25, 90, 40}, kGap{224, 140, 20},
    kOther{150, 150, 150};
constexpr Colour kRowText{60, 110, 70}, kBar{90, 150, 105};
constexpr double kTreePx = 4.0, kTreeManyPx = 2.5, kGapPx = 3.5;
constexpr std::size_t kMany = 400;

void draw_gap(PixelPoint centre, double radius_px, Canvas& canvas) {
  canvas.circle(centre, radius_px, kWhite, kGap);
}

/// All data for the drawing, copied because it is drawn later.
struct Block {
  std::vector<Landmark> landmarks;
  std::vector<mapping::InventoryGap> gaps;
  std::map<std::int32_t, std::map<std::int32_t, Eigen::Vector2d>> rows;  ///< trees by position
  double tree_px = kTreePx;
  std::string row_short;
};

std::vector<LegendItem> legend_of(const Block& block, const ReportTexts& texts) {
  std::vector<LegendItem> items;
  items.push_back({texts.legend_tree, [](PixelPoint centre, Canvas& canvas) {
                     canvas.circle(centre, kTreePx, kTree, kTreeBorder);
                   }});
  if (!block.gaps.empty()) {
    items.push_back({texts.legend_gap,
                     [](PixelPoint centre, Canvas& canvas) { draw_gap(centre, kGapPx, canvas); }});
  }
  items.push_back({texts.legend_object, [](PixelPoint centre, Canvas& canvas) {
                     canvas.circle(centre, 2.5, kOther, kOther);
                   }});
  return items;
}

void draw_row_numbers(const Block& block, const MapFrame& frame, LabelPlacement& placement,
                      Canvas& canvas) {
  constexpr double kOut_px = 13.0, kText_px = 12.0;
  for (const auto& [number, trees] : block.rows) {
    const Eigen::Vector2d& first = trees.begin()->second;
    const Eigen::Vector2d& last = trees.rbegin()->second;
    const PixelPoint from = frame.at(first.x(), first.y()), to = frame.at(last.x(), last.y());
    const double length_px = std::hypot(from.x - to.x, from.y - to.y);
    const double fraction = length_px > 0.0 ? kOut_px / length_px : 0.0;
    draw_label({from.x + fraction * (from.x - to.x), from.y + fraction * (from.y - to.y)}, 0.0,
               block.row_short + std::to_string(number), kText_px, kRowText, placement, &canvas);
  }
}

void draw_block(const Block& block, const MapFrame& frame, Canvas& canvas) {
  frame.draw(canvas);
  LabelPlacement placement(frame.box());
  const auto take = [&placement](PixelPoint p, double radius_px) {
    placement.take({p.x - radius_px, p.y - radius_px, p.x + radius_px, p.y + radius_px});
  };
  for (const Landmark& l : block.landmarks) {
    if (l.label == detection::Label::kTree) continue;
    const PixelPoint p = frame.at(l.x_m, l.y_m);
    canvas.circle(p, 0.6 * block.tree_px, kOther, kOther);
    take(p, block.tree_px);
  }
  for (const mapping::InventoryGap& gap : block.gaps) {
    const PixelPoint p = frame.at(gap.p_map.x(), gap.p_map.y());
    draw_gap(p, 0.9 * block.tree_px, canvas);
    take(p, block.tree_px);
  }
  for (const Landmark& l : block.landmarks) {
    if (l.label != detection::Label::kTree) continue;
    const PixelPoint p = frame.at(l.x_m, l.y_m);
    const double radius_px = std::max(block.tree_px, 0.5 * l.width_m * frame.px_per_m());
    canvas.circle(p, radius_px, kTree, kTreeBorder);
    take(p, radius_px);
  }
  draw_row_numbers(block, frame, placement, canvas);
}

}  // namespace

DocumentFigure block_figure(const std::vector<Landmark>& landmarks,
                            const mapping::Inventory& inventory, std::optional<double> north_rad,
                            const ReportTexts& texts) {
  auto block = std::make_shared<Block>();
  block->landmarks = landmarks;
  block->gaps = inventory.all.gaps;
  block->tree_px = landmarks.size() > kMany ? kTreeManyPx : kTreePx;
  block->row_short = texts.row_short;
  std::vector<Eigen::Vector2d> points;
  for (const Landmark& l : landmarks) {
    points.push_back({l.x_m, l.y_m});
    if (l.label == detection::Label::kTree && l.row > 0 && l.position > 0) {
      block->rows[l.row][l.position] = points.back();
    }
  }
  MapHeading heading;
  heading.north_rad = north_rad;
  const auto frame = std::make_shared<const MapFrame>(points, legend_of(*block, texts), heading,
                                                      PlotSizeMax{760.0, 860.0});
  return {frame->width_px(), frame->height_px(),
          [block, frame](Canvas& canvas) { draw_block(*block, *frame, canvas); }};
}

DocumentFigure diameter_figure(const mapping::DiameterHistogram& histogram,
                               const ReportTexts& texts) {
  constexpr int kWidth_px = 640, kHeight_px = 260;
  const std::string x_name = texts.diameter_axis, y_name = texts.trees_axis;
  return {kWidth_px, kHeight_px, [histogram, x_name, y_name](Canvas& canvas) {
            const int most = *std::max_element(histogram.counts.begin(), histogram.counts.end());
            const double class_cm = 100.0 * histogram.class_m;
            const auto first =
                static_cast<double>(std::find_if(histogram.counts.begin(), histogram.counts.end(),
                                                 [](int count) { return count > 0; }) -
                                    histogram.counts.begin());
            const PixelBox box{PlotAxes::kLeftPx, 14.0, kWidth_px - PlotAxes::kRightPx,
                               kHeight_px - PlotAxes::kBottomPx};
            const PlotAxes axes(box,
                                {class_cm * std::max(0.0, first - 1.0),
                                 class_cm * (static_cast<double>(histogram.counts.size()) + 1.0)},
                                {0.0, 1.1 * most});
            axes.draw(x_name, y_name, canvas);
            for (std::size_t i = 0; i < histogram.counts.size(); ++i) {
              if (histogram.counts[i] == 0) continue;
              const PixelPoint low = axes.at(class_cm * static_cast<double>(i), 0.0);
              const PixelPoint high =
                  axes.at(class_cm * static_cast<double>(i + 1), histogram.counts[i]);
              canvas.rectangle({low.x + 0.5, high.y, high.x - 0.5, low.y}, kBar, kTreeBorder, 0.5);
            }
          }};
}

}  // namespace orchard::io
