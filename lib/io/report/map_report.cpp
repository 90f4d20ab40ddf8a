// SPDX-License-Identifier: BSD-3-Clause
#include "io/report/map_report.hpp"

#include <fmt/args.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "geometry/angles.hpp"
#include "geometry/georeference.hpp"
#include "io/csv.hpp"
#include "io/figure/map_frame.hpp"
#include "io/figure/plot_axes.hpp"
#include "io/report/document.hpp"
#include "io/report/report_texts.hpp"
#include "mapping/inventory/inventory.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

using mapping::Change;
using mapping::GrowthByRow;
using mapping::Inventory;
using mapping::Kind;
using mapping::Landmark;
using mapping::RowInventory;

constexpr Colour kBar{90, 150, 105};
constexpr double kNumber_px = 10.0, kTreePx = 4.0, kTreeManyPx = 2.5, kGapPx = 3.5;
constexpr std::size_t kMany = 400;
constexpr double kWidthMax_px = 760.0, kHeightMax_px = 860.0;  ///< derived: a page of A4
/// derived: so many symbols of kTreeManyPx fill the page, side by side; more hide each other.
constexpr auto kDrawnMax =
    static_cast<std::size_t>(kWidthMax_px * kHeightMax_px / (4.0 * kTreeManyPx * kTreeManyPx));

void draw_gap(PixelPoint centre, double radius_px, Canvas& canvas) {
  canvas.circle(centre, radius_px, kWhite, kGapColour);
}

/// What the block's picture shows.
struct Block {
  const ReportContent& content;
  const mapping::Inventory& inventory;
  const ReportTexts& texts;

  const std::vector<Landmark>& landmarks() const { return content.map.landmarks; }
  const mapping::KindCounts& kinds() const { return inventory.kinds; }
  double tree_px() const { return landmarks().size() > kMany ? kTreeManyPx : kTreePx; }
};

std::vector<LegendItem> legend_of(const Block& block) {
  std::vector<LegendItem> items;
  items.push_back({block.texts.legend_tree, [](PixelPoint centre, Canvas& canvas) {
                     canvas.circle(centre, kTreePx, kTreeColour, kTreeInk);
                   }});
  if (block.kinds().has_rows() && block.kinds().of(mapping::Kind::kTrunk) > 0) {
    items.push_back({block.texts.legend_other, [](PixelPoint centre, Canvas& canvas) {
                       canvas.circle(centre, kTreePx, kTrunkColour, kTrunkInk);
                     }});
  }
  if (!block.inventory.all.gaps.empty()) {
    items.push_back({block.texts.legend_gap,
                     [](PixelPoint centre, Canvas& canvas) { draw_gap(centre, kGapPx, canvas); }});
  }
  items.push_back({block.texts.legend_object, [](PixelPoint centre, Canvas& canvas) {
                     canvas.circle(centre, 2.5, kUnseenColour, kUnseenColour);
                   }});
  return items;
}

void draw_block(const Block& block, const MapFrame& frame, Canvas& canvas) {
  frame.draw(canvas);
  LabelPlacement placement(frame.box());
  const double tree_px = block.tree_px();
  const auto take = [&placement](PixelPoint p, double radius_px) {
    placement.take({p.x - radius_px, p.y - radius_px, p.x + radius_px, p.y + radius_px});
  };
  for (const Landmark& l : block.landmarks()) {
    if (l.label == detection::Label::kTree) continue;
    const PixelPoint p = frame.at(l.x_m, l.y_m);
    canvas.circle(p, 0.6 * tree_px, kUnseenColour, kUnseenColour);
    take(p, tree_px);
  }
  for (const mapping::InventoryGap& gap : block.inventory.all.gaps) {
    const PixelPoint p = frame.at(gap.p_map.x(), gap.p_map.y());
    draw_gap(p, 0.9 * tree_px, canvas);
    take(p, tree_px);
  }
  for (const bool is_counted : {false, true}) {  // trees on top
    for (const Landmark& l : block.landmarks()) {
      if (l.label != detection::Label::kTree) continue;
      if (block.kinds().counts(mapping::kind_of(l)) != is_counted) continue;
      const PixelPoint p = frame.at(l.x_m, l.y_m);
      const double radius_px = std::max(tree_px, 0.5 * l.width_m * frame.px_per_m());
      canvas.circle(p, radius_px, is_counted ? kTreeColour : kTrunkColour,
                    is_counted ? kTreeInk : kTrunkInk);
      take(p, radius_px);
    }
  }
  std::map<std::int32_t, std::map<std::int32_t, PixelPoint>> rows;  // trees by position
  std::vector<NumberLabel> numbers;
  for (const Landmark& l : block.landmarks()) {
    if (l.label != detection::Label::kTree || l.position == 0) continue;
    const PixelPoint p = frame.at(l.x_m, l.y_m);
    if (l.row > 0 && l.position > 0) rows[l.row][l.position] = p;
    numbers.push_back({p, tree_px, l.position, std::to_string(l.position), kTreeInk});
  }
  for (const auto& [number, trees] : rows) {
    draw_row_name(trees.begin()->second, trees.rbegin()->second,
                  mapping::row_name(block.content.row_names, number, block.texts.row_short),
                  kRowInk, placement, canvas);
  }
  draw_numbers(numbers, kNumber_px, placement, canvas);
}

/// Draws the block for the grower: trees by trunk diameter, gaps, other objects and row numbers.
std::string block_figure(const Block& block) {
  std::vector<Eigen::Vector2d> points;
  for (const Landmark& l : block.landmarks()) points.push_back({l.x_m, l.y_m});
  MapHeading heading;
  if (const auto& georeference = block.content.map.georeference) {
    heading.north_rad = 0.5 * geometry::kPi - georeference->yaw_rad;
  }
  const MapFrame frame(points, legend_of(block), heading, PlotSizeMax{kWidthMax_px, kHeightMax_px});
  Canvas canvas(FigureFormat::kSvg, frame.width_px(), frame.height_px());
  draw_block(block, frame, canvas);
  return canvas.finish();
}

/// Draws a histogram of trunk diameters.
std::string diameter_figure(const mapping::DiameterHistogram& histogram, const ReportTexts& texts) {
  constexpr int kWidth_px = 640, kHeight_px = 260;
  const std::vector<int>& counts = histogram.counts;
  const double class_cm = 100.0 * histogram.class_m;
  const auto first = static_cast<double>(
      std::find_if(counts.begin(), counts.end(), [](int count) { return count > 0; }) -
      counts.begin());
  const PixelBox box{PlotAxes::kLeftPx, 14.0, kWidth_px - PlotAxes::kRightPx,
                     kHeight_px - PlotAxes::kBottomPx};
  const PlotAxes axes(box,
                      {class_cm * std::max(0.0, first - 1.0),
                       class_cm * (static_cast<double>(counts.size()) + 1.0)},
                      {0.0, 1.1 * *std::max_element(counts.begin(), counts.end())});
  Canvas canvas(FigureFormat::kSvg, kWidth_px, kHeight_px);
  axes.draw(texts.diameter_axis, texts.trees_axis, canvas);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 0) continue;
    const PixelPoint low = axes.at(class_cm * static_cast<double>(i), 0.0);
    const PixelPoint high = axes.at(class_cm * static_cast<double>(i + 1), counts[i]);
    canvas.rectangle({low.x + 0.5, high.y, high.x - 0.5, low.y}, kBar, kTreeInk, 0.5);
  }
  return canvas.finish();
}

constexpr std::size_t kGapsListedMax = 500;

/// Growth per row, used by the document and the CSV; empty without an earlier map.
GrowthByRow growth_of(const ReportContent& content) {
  if (!content.earlier) return {};
  return mapping::growth_by_row(content.earlier->landmarks, content.map.landmarks,
                                content.earlier->comparison);
}

mapping::Growth growth_in(const GrowthByRow& growth, std::int32_t row) {
  const auto it = growth.find(row);
  return it == growth.end() ? mapping::Growth() : it->second;
}

/// Writes one report; formats all numbers for its language.
class Writer {
 public:
  Writer(const ReportContent& content, const ReportTexts& texts)
      : content_(content),
        texts_(texts),
        inventory_(mapping::compute_inventory(content.map.landmarks)),
        growth_(growth_of(content)),
        document_(texts.language, say(texts.title, {content.name}),
                  say(texts.subtitle, {day_text(content.facts.day), content.facts.version})) {}

  std::string html() {
    write_counts();
    if (!inventory_.rows.empty()) write_rows();
    if (mapping::has_slopes(inventory_)) write_slopes();
    write_diameters();
    write_picture();
    if (!inventory_.rows.empty()) write_gaps();
    write_plan();
    write_changes();
    write_not_seen();
    write_certainty();
    return document_.html();
  }

 private:
  static std::string say(const char* sentence, const std::vector<std::string>& words) {
    fmt::dynamic_format_arg_store<fmt::format_context> store;
    for (const std::string& word : words) store.push_back(word);
    return fmt::vformat(sentence, store);
  }
  std::string number(double value, int num_decimals) const {
    std::string text = fixed_text(value, num_decimals);
    std::replace(text.begin(), text.end(), '.', texts_.decimal_point);
    return text;
  }
  static std::string number(int value) { return std::to_string(value); }
  std::string day_text(const std::string& day) const {
    return day.empty() ? texts_.unknown_day : day;
  }
  void heading(const char* text) { document_.add_heading(text); }
  void text(const std::string& text) { document_.add_text(text); }
  std::string row_name(std::int32_t row) const {
    return mapping::row_name(content_.row_names, row);
  }

  void write_counts() {
    heading(texts_.counts);
    const RowInventory &all = inventory_.all, &other = inventory_.other;
    if (inventory_.rows.empty()) {
      text(say(texts_.trunks, {number(all.num_trees)}));
    } else {
      text(say(texts_.trees,
               {number(all.num_trees), number(static_cast<int>(inventory_.rows.size()))}));
      text(say(texts_.gaps, {number(static_cast<int>(all.gaps.size()))}));
    }
    if (all.num_measured > 0) {
      text(say(texts_.area, {number(all.tcsa_cm2, 0), number(all.tcsa_cm2 / all.num_measured, 1)}));
      text(texts_.area_note);
    }
    if (other.num_trees > 0) {
      text(say(texts_.other_trunks, {number(other.num_trees), number(other.tcsa_cm2, 0)}));
    }
    const int num_objects = inventory_.kinds.of(Kind::kObject);
    if (num_objects > 0) text(say(texts_.objects, {number(num_objects)}));
  }

  void write_picture() {
    heading(texts_.picture);
    const std::size_t num = content_.map.landmarks.size();
    if (num > kDrawnMax) {
      text(say(texts_.no_picture, {std::to_string(num), std::to_string(kDrawnMax)}));
      return;
    }
    document_.add_figure(block_figure({content_, inventory_, texts_}));
  }

  std::vector<std::string> row_cells(const std::string& name, const RowInventory& row,
                                     std::int32_t growth_row) const {
    std::string positions;
    if (growth_row >= 0) {
      for (const mapping::InventoryGap& gap : row.gaps) {
        positions += (positions.empty() ? "" : ", ") + std::to_string(gap.position);
      }
    }
    const bool is_measured = row.num_measured > 0;
    std::vector<std::string> cells{name,
                                   number(row.num_trees),
                                   number(static_cast<int>(row.gaps.size())),
                                   positions,
                                   is_measured ? number(100.0 * row.diameter_mean_m, 1) : "",
                                   is_measured ? number(row.tcsa_cm2, 0) : "",
                                   row.tcsa_sd_cm2 > 0.0 ? number(row.tcsa_sd_cm2, 0) : ""};
    if (!content_.earlier) return cells;
    const mapping::Growth growth = growth_in(growth_, growth_row);
    cells.push_back(number(growth.num_pairs));
    cells.push_back(growth.num_pairs > 0 ? number(growth.tcsa_change_cm2, 0) : "");
    cells.push_back(growth.num_pairs > 0 ? number(growth.percent(), 1) : "");
    return cells;
  }

  void write_rows() {
    heading(texts_.rows);
    DocumentTable table;
    table.head = {texts_.column_row,           texts_.column_trees,    texts_.column_gaps,
                  texts_.column_gap_positions, texts_.column_diameter, texts_.column_area,
                  texts_.column_area_error};
    if (content_.earlier) {
      table.head.insert(table.head.end(),
                        {texts_.column_pairs, texts_.column_growth, texts_.column_growth_percent});
    }
    table.text_columns = {3};
    table.has_sum = true;
    for (const RowInventory& row : inventory_.rows) {
      table.rows.push_back(row_cells(row_name(row.row), row, row.row));
    }
    table.rows.push_back(row_cells(texts_.total, inventory_.all, mapping::kGrowthOfAll));
    document_.add_table(table);
    write_late_rows();
  }

  void write_slopes() {
    heading(texts_.slopes);
    DocumentTable table;
    table.head = {texts_.column_row, texts_.column_slope, texts_.column_slope_error,
                  texts_.column_rise};
    for (const RowInventory& row : inventory_.rows) {
      if (!row.slope) continue;
      table.rows.push_back({row_name(row.row), number(row.slope->percent, 1),
                            number(row.slope->percent_sd, 1), number(row.slope->rise_m, 2)});
    }
    document_.add_table(table);
    text(texts_.slopes_note);
  }

  /// Says why rows begin with another number than the others.
  void write_late_rows() {
    std::int32_t first = std::numeric_limits<std::int32_t>::max();
    for (const RowInventory& row : inventory_.rows) first = std::min(first, row.first_position);
    std::string late;
    for (const RowInventory& row : inventory_.rows) {
      if (row.first_position <= first) continue;
      late += (late.empty() ? "" : ", ") +
              say(texts_.late_row, {row_name(row.row), number(row.first_position)});
    }
    if (!late.empty()) text(say(texts_.late_rows, {late}));
  }

  void write_diameters() {
    heading(texts_.diameters);
    const mapping::DiameterHistogram histogram =
        mapping::diameter_histogram(content_.map.landmarks);
    if (histogram.counts.empty()) return text(texts_.diameters_none);
    document_.add_figure(diameter_figure(histogram, texts_));
  }

  void write_gaps() {
    heading(texts_.gap_places);
    if (inventory_.all.gaps.empty()) return text(texts_.gap_none);
    DocumentTable table;
    table.head = {texts_.column_row, texts_.column_position, texts_.column_place};
    const auto& georeference = content_.map.georeference;
    if (georeference) table.head.push_back(texts_.column_geodetic);
    for (const RowInventory& row : inventory_.rows) {
      for (const mapping::InventoryGap& gap : row.gaps) {
        if (table.rows.size() >= kGapsListedMax) break;
        table.rows.push_back({row_name(row.row), std::to_string(gap.position),
                              number(gap.p_map.x(), 2) + "; " + number(gap.p_map.y(), 2)});
        if (!georeference) continue;
        const geometry::Geodetic place = geometry::geodetic_of(*georeference, gap.p_map);
        // A decimal point in every language, for copying into a telephone.
        table.rows.back().push_back(fixed_text(place.latitude_deg, 7) + ", " +
                                    fixed_text(place.longitude_deg, 7));
      }
    }
    document_.add_table(table);
    text(texts_.gap_note);
  }

  void write_plan() {
    if (!content_.plan) return;
    heading(texts_.plan);
    text(say(texts_.plan_of, {content_.plan->name}));
    DocumentTable table;
    table.head = {texts_.plan_column_row,
                  texts_.as_planned,
                  texts_.out_of_place,
                  texts_.plan_missing,
                  texts_.plan_not_seen,
                  texts_.extra,
                  ""};
    table.text_columns = {6};
    table.has_sum = true;
    PlannedRowCounts all;
    all.name = texts_.total;
    const auto add = [&](const PlannedRowCounts& row) {
      std::vector<std::string>& cells = table.rows.emplace_back();
      cells.push_back(row.name);
      for (const int count : row.counts) cells.push_back(number(count));
      cells.push_back(row.is_shifted ? texts_.shifted : "");
    };
    for (const PlannedRowCounts& row : content_.plan->rows) {
      add(row);
      for (std::size_t k = 0; k < row.counts.size(); ++k) all.counts[k] += row.counts[k];
    }
    add(all);
    document_.add_table(table);
  }

  /// Number of trees that count with this change, in the map that has them.
  int num_changed(Change change) const {
    const auto& before = content_.earlier->landmarks;
    const auto& now = content_.map.landmarks;
    const mapping::KindCounts kinds_before(before);
    const auto& changes = content_.earlier->comparison.changes;
    return static_cast<int>(std::count_if(changes.begin(), changes.end(), [&](const auto& c) {
      const Landmark& l = c.b >= 0 ? now.at(static_cast<std::size_t>(c.b))
                                   : before.at(static_cast<std::size_t>(c.a));
      const mapping::KindCounts& kinds = c.b >= 0 ? inventory_.kinds : kinds_before;
      return c.change == change && kinds.counts(mapping::kind_of(l));
    }));
  }

  void write_changes() {
    if (!content_.earlier) return;
    heading(texts_.changes);
    const EarlierMap& earlier = *content_.earlier;
    text(say(texts_.changes_since, {earlier.name, day_text(earlier.day)}));
    DocumentTable table;
    table.head = {texts_.column_change, texts_.column_count};
    const std::array<std::pair<Change, const char*>, mapping::kNumChanges> changes{
        {{Change::kMissing, texts_.missing},
         {Change::kNew, texts_.new_trees},
         {Change::kMoved, texts_.moved},
         {Change::kGrown, texts_.grown},
         {Change::kThinner, texts_.thinner},
         {Change::kUnchanged, texts_.unchanged},
         {Change::kNotSeen, texts_.not_compared}}};
    for (const auto& [change, words] : changes) {
      table.rows.push_back({words, number(num_changed(change))});
    }
    document_.add_table(table);
    heading(texts_.growth);
    const mapping::Growth all = growth_in(growth_, mapping::kGrowthOfAll);
    text(say(texts_.growth_all, {number(1e3 * earlier.comparison.width_change_common_m, 1),
                                 number(1e3 * earlier.comparison.width_change_common_se_m, 1),
                                 number(all.num_pairs), number(all.tcsa_change_cm2, 0)}));
  }

  void write_not_seen() {
    heading(texts_.not_seen);
    const SummaryFacts& facts = content_.facts;
    if (const int num_unseen = inventory_.kinds.of(Kind::kUnseen); num_unseen > 0) {
      const bool has_camera = facts.has_pictures.value_or(false);
      text(say(has_camera ? texts_.unseen : texts_.unclassified, {number(num_unseen)}));
    } else if (facts.has_pictures == true) {
      text(texts_.all_seen);
    }
    if (facts.has_pictures == false) text(texts_.no_camera);
    if (facts.without_pictures_s > 0.0) {
      text(say(texts_.without_pictures,
               {number(facts.without_pictures_s, 0), number(facts.num_met_without_pictures)}));
    }
    if (facts.without_fixes_s > 0.0) {
      text(say(texts_.without_fixes, {number(facts.without_fixes_s, 0)}));
    }
    if (content_.earlier) {
      const auto& changes = content_.earlier->comparison.changes;
      const auto num = std::count_if(changes.begin(), changes.end(), [](const auto& c) {
        return c.change == Change::kNotSeen && c.a >= 0 && c.b < 0;
      });
      if (num > 0) text(say(texts_.changes_not_seen, {std::to_string(num)}));
    }
    for (const std::string& warning : facts.warnings) text(say(texts_.warnings, {warning}));
  }

  void write_certainty() {
    heading(texts_.how_sure);
    const mapping::CertaintyCounts& certainty = inventory_.certainty;
    text(say(texts_.sure, {number(certainty.num_sure), number(certainty.num_likely),
                           number(certainty.num_unsure)}));
    if (inventory_.position_se_median_m > 0.0) {
      text(say(texts_.places, {number(100.0 * inventory_.position_se_median_m, 1)}));
    }
    if (inventory_.width_sd_median_m > 0.0) {
      text(say(texts_.widths, {number(1e3 * inventory_.width_sd_median_m, 1)}));
      text(texts_.width_bias);
    }
  }

  const ReportContent& content_;
  const ReportTexts& texts_;
  Inventory inventory_;
  GrowthByRow growth_;
  Document document_;
};

}  // namespace

const ReportTexts* find_report_texts(const std::string& language) {
  static const ReportTexts kEnglish(0), kSpanish(1);
  for (const ReportTexts* texts : {&kEnglish, &kSpanish}) {
    if (language == texts->language) return texts;
  }
  return nullptr;
}

std::string map_report(const ReportContent& content, const ReportTexts& texts) {
  return Writer(content, texts).html();
}

std::vector<std::vector<std::string>> report_table(const ReportContent& content) {
  const Inventory inventory = mapping::compute_inventory(content.map.landmarks);
  const GrowthByRow growth = growth_of(content);
  std::vector<std::vector<std::string>> table{{"row", "trees", "empty_places", "empty_positions",
                                               "diameter_mean_cm", "tcsa_cm2", "tcsa_sd_cm2"}};
  if (content.earlier) {
    for (const char* name : {"measured_twice", "tcsa_growth_cm2", "tcsa_growth_percent"}) {
      table.front().push_back(name);
    }
  }
  const bool has_slopes = mapping::has_slopes(inventory);
  if (has_slopes) {
    for (const char* name : {"slope_percent", "slope_sd_percent", "rise_m"}) {
      table.front().push_back(name);
    }
  }
  const auto add_slope = [&](const std::optional<mapping::RowSlope>& slope) {
    if (!has_slopes) return;
    table.back().push_back(slope ? fixed_text(slope->percent, 2) : "");
    table.back().push_back(slope ? fixed_text(slope->percent_sd, 2) : "");
    table.back().push_back(slope ? fixed_text(slope->rise_m, 3) : "");
  };
  const auto line = [&](const std::string& name, const RowInventory& row, std::int32_t of) {
    std::string positions;
    for (const mapping::InventoryGap& gap : row.gaps) {
      if (of > 0) positions += (positions.empty() ? "" : " ") + std::to_string(gap.position);
    }
    table.push_back({name, std::to_string(row.num_trees), std::to_string(row.gaps.size()),
                     positions, fixed_text(100.0 * row.diameter_mean_m, 2),
                     fixed_text(row.tcsa_cm2, 1), fixed_text(row.tcsa_sd_cm2, 1)});
    if (!content.earlier) return add_slope(row.slope);
    const mapping::Growth g = growth_in(growth, of);
    table.back().push_back(std::to_string(g.num_pairs));
    table.back().push_back(fixed_text(g.tcsa_change_cm2, 1));
    table.back().push_back(fixed_text(g.percent(), 2));
    add_slope(row.slope);
  };
  for (const RowInventory& row : inventory.rows) {
    line(csv_field(mapping::row_name(content.row_names, row.row)), row, row.row);
  }
  line("all", inventory.all, mapping::kGrowthOfAll);
  if (inventory.other.num_trees > 0) line("other_trunks", inventory.other, 0);
  return table;
}

std::string report_csv(const std::vector<std::vector<std::string>>& table) {
  std::string csv;
  for (const std::vector<std::string>& line : table) {
    for (std::size_t i = 0; i < line.size(); ++i) csv += (i > 0 ? "," : "") + line[i];
    csv += "\n";
  }
  return csv;
}

}  // namespace orchard::io
