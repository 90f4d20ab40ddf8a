// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/comparison_files.hpp"

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "detection/detection.hpp"
#include "geometry/angles.hpp"
#include "io/atomic_file.hpp"
#include "io/folder.hpp"
#include "io/gis/geopackage.hpp"
#include "io/gis/qgis_style.hpp"
#include "io/map/map_csv.hpp"
#include "io/map/rounded.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

using mapping::Change;
using mapping::Landmark;
using mapping::MapChange;
using Json = nlohmann::ordered_json;

constexpr Change kAllChanges[] = {Change::kMissing, Change::kNew,     Change::kMoved,
                                  Change::kGrown,   Change::kThinner, Change::kUnchanged,
                                  Change::kNotSeen};

const Landmark* of_a(const ComparisonContent& content, const MapChange& c) {
  return c.a < 0 ? nullptr : &content.a[static_cast<std::size_t>(c.a)];
}
const Landmark* of_b(const ComparisonContent& content, const MapChange& c) {
  return c.b < 0 ? nullptr : &content.b[static_cast<std::size_t>(c.b)];
}

/// The landmark whose id the user knows: that of the earlier map, else of the later one.
const Landmark& known_as(const ComparisonContent& content, const MapChange& c) {
  const Landmark* a = of_a(content, c);
  const Landmark* b = of_b(content, c);
  return a != nullptr && (a->row != 0 || b == nullptr) ? *a : b != nullptr ? *b : *a;
}

std::string comparison_geopackage(const ComparisonContent& content) {
  GeoPackage file(content.georeference);
  std::vector<GeoField> fields{{"change", GeoType::kText},
                               {"confidence", GeoType::kReal},
                               {"id_a", GeoType::kInteger},
                               {"id_b", GeoType::kInteger},
                               {"class_a", GeoType::kText},
                               {"class_b", GeoType::kText},
                               {"moved_m", GeoType::kReal},
                               {"width_a_m", GeoType::kReal},
                               {"width_b_m", GeoType::kReal},
                               {"width_change_m", GeoType::kReal},
                               {"width_change_se_m", GeoType::kReal},
                               {"row", GeoType::kInteger},
                               {"position", GeoType::kInteger}};
  QgisStyle style;
  style.field = "change";
  style.symbols = {{"missing", "missing", "cross_fill", "198,40,40", 3.0},
                   {"new", "new", "circle", "46,125,50", 3.0},
                   {"moved", "moved", "arrow", "239,108,0", 3.0},
                   {"grown", "grown", "triangle", "66,120,190", 2.4},
                   {"thinner", "thinner", "diamond", "142,36,170", 2.4},
                   {"unchanged", "unchanged", "circle", "180,200,180", 1.4},
                   {"not_seen", "not seen by both", "circle", "200,200,200", 1.2}};
  file.begin_layer(
      {"changes", GeoGeometry::kPoint, "What changed between two maps", fields, qml_text(style)});
  const auto integer = [](std::int64_t value) { return GeoValue(value); };
  for (const MapChange& c : content.comparison.changes) {
    const Landmark* a = of_a(content, c);
    const Landmark* b = of_b(content, c);
    const Landmark& known = known_as(content, c);
    const bool is_pair = a != nullptr && b != nullptr;
    file.add(
        {std::string(mapping::change_text(c.change)), c.confidence, a ? integer(a->id) : GeoValue(),
         b ? integer(b->id) : GeoValue(),
         a ? GeoValue(std::string(label_text(a->label))) : GeoValue(),
         b ? GeoValue(std::string(label_text(b->label))) : GeoValue(),
         is_pair ? GeoValue(c.moved_m) : GeoValue(), a ? GeoValue(a->width_m) : GeoValue(),
         b ? GeoValue(b->width_m) : GeoValue(), is_pair ? GeoValue(c.width_change_m) : GeoValue(),
         is_pair ? GeoValue(c.width_change_se_m) : GeoValue(),
         known.row ? integer(known.row) : GeoValue(),
         known.position ? integer(known.position) : GeoValue()},
        {c.p_a});
  }
  return file.finish();
}

/// compare.csv as text: change,confidence,id_a,id_b,class_a,class_b,x_m,y_m,moved_m,width_a_m,
/// width_b_m,width_change_m,width_change_se_m,row,position. Positions are in the frame of the
/// earlier map.
std::string comparison_csv(const ComparisonContent& content) {
  std::string text =
      "change,confidence,id_a,id_b,class_a,class_b,x_m,y_m,moved_m,width_a_m,width_b_m,"
      "width_change_m,width_change_se_m,row,position\n";
  for (const MapChange& c : content.comparison.changes) {
    const Landmark* a = of_a(content, c);
    const Landmark* b = of_b(content, c);
    const Landmark& known = known_as(content, c);
    const bool is_pair = a != nullptr && b != nullptr;
    text += std::string(mapping::change_text(c.change)) + "," + fixed_text(c.confidence, 4) + "," +
            (a ? std::to_string(a->id) : "") + "," + (b ? std::to_string(b->id) : "") + "," +
            (a ? label_text(a->label) : "") + "," + (b ? label_text(b->label) : "") + "," +
            fixed_text(c.p_a.x(), 4) + "," + fixed_text(c.p_a.y(), 4) + "," +
            (is_pair ? fixed_text(c.moved_m, 4) : "") + "," + (a ? fixed_text(a->width_m, 4) : "") +
            "," + (b ? fixed_text(b->width_m, 4) : "") + "," +
            (is_pair ? fixed_text(c.width_change_m, 4) : "") + "," +
            (is_pair ? fixed_text(c.width_change_se_m, 4) : "") + "," + number_or_empty(known.row) +
            "," + number_or_empty(known.position) + "\n";
  }
  return text;
}

}  // namespace

std::string comparison_json(const ComparisonContent& content) {
  const mapping::MapAlignment& alignment = content.alignment;
  Json json;
  json["a"] = content.name_a;
  json["b"] = content.name_b;
  json["alignment"] = {{"x_m", rounded(alignment.T_a_b.x_m)},
                       {"y_m", rounded(alignment.T_a_b.y_m)},
                       {"yaw_rad", rounded(alignment.T_a_b.yaw_rad, 1e6)},
                       {"sd_x_m", rounded(std::sqrt(alignment.covariance(0, 0)))},
                       {"sd_y_m", rounded(std::sqrt(alignment.covariance(1, 1)))},
                       {"sd_yaw_rad", rounded(std::sqrt(alignment.covariance(2, 2)), 1e6)},
                       {"pairs", alignment.pairs.size()},
                       {"rms_m", rounded(alignment.rms_m)},
                       {"position_sd_m", rounded(alignment.position_sd_m)}};
  for (const Change change : kAllChanges) {
    json["counts"][mapping::change_text(change)] = content.comparison.count(change);
  }
  json["width_change_common_m"] = rounded(content.comparison.width_change_common_m);
  json["width_change_common_se_m"] = rounded(content.comparison.width_change_common_se_m);
  json["changes"] = Json::array();
  std::string text = json.dump(1, ' ', false, Json::error_handler_t::replace);
  const std::string end = "]\n}\n";
  text.resize(text.size() + 1 - end.size());
  // One by one: as one document they would need 100 MB for 100,000 trees.
  for (const MapChange& c : content.comparison.changes) {
    const Landmark* a = of_a(content, c);
    const Landmark* b = of_b(content, c);
    const Landmark& known = known_as(content, c);
    Json entry;
    entry["change"] = mapping::change_text(c.change);
    entry["confidence"] = rounded(c.confidence);
    if (a) entry["id_a"] = a->id;
    if (b) entry["id_b"] = b->id;
    entry["x_m"] = rounded(c.p_a.x());
    entry["y_m"] = rounded(c.p_a.y());
    if (a) entry["width_a_m"] = rounded(a->width_m);
    if (b) entry["width_b_m"] = rounded(b->width_m);
    if (a && b) {
      entry["moved_m"] = rounded(c.moved_m);
      entry["width_change_m"] = rounded(c.width_change_m);
      entry["width_change_se_m"] = rounded(c.width_change_se_m);
    }
    if (known.row != 0) entry["row"] = known.row;
    if (known.position != 0) entry["position"] = known.position;
    text += text.back() == '[' ? "\n  " : ",\n  ";
    for (const char c : entry.dump(1, ' ', false, Json::error_handler_t::replace)) {
      text += c;
      if (c == '\n') text += "  ";
    }
  }
  return text + (text.back() == '[' ? "" : "\n ") + end;
}

void write_comparison_folder(const std::string& folder, const ComparisonContent& content) {
  make_folder(folder, "choose another folder for the comparison");
  const std::filesystem::path path(folder);
  FileReplacement files;
  files.write((path / "compare.csv").string(), comparison_csv(content));
  files.write((path / "compare.gpkg").string(), comparison_geopackage(content));
  files.write((path / "compare.svg").string(), comparison_figure(content, FigureFormat::kSvg));
  files.write((path / "compare.png").string(), comparison_figure(content, FigureFormat::kPng));
  files.write((path / "compare.json").string(), comparison_json(content));
  files.commit();
}

}  // namespace orchard::io
