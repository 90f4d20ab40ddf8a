// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/summary_json.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "io/map/rounded.hpp"
#include "mapping/rows/navigation_graph.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

using Json = nlohmann::ordered_json;

std::int64_t count_of(const MapFolderContent& content, detection::Label label) {
  return std::count_if(content.landmarks.begin(), content.landmarks.end(),
                       [label](const mapping::Landmark& l) { return l.label == label; });
}

double path_length_m(const std::vector<pose::PoseEstimate>& path) {
  double length_m = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    length_m += std::hypot(path[i].x_m - path[i - 1].x_m, path[i].y_m - path[i - 1].y_m);
  }
  return length_m;
}

/// Id above all landmarks of this and earlier maps.
std::int32_t next_id(const MapFolderContent& content) {
  std::int32_t next = std::max(1, content.next_id);
  for (const mapping::Landmark& l : content.landmarks) next = std::max(next, l.id + 1);
  return next;
}

Json view_json(const mapping::SensorView& view) {
  return {{"reach_m", millimetres(view.reach_m)},
          {"bearing_min_rad", rounded(view.bearing_min_rad, 1e6)},
          {"bearing_max_rad", rounded(view.bearing_max_rad, 1e6)},
          {"mount_x_m", millimetres(view.mount_x_m)},
          {"mount_y_m", millimetres(view.mount_y_m)},
          {"mount_yaw_rad", rounded(view.mount_yaw_rad, 1e6)},
          {"min_observations", view.min_observations}};
}

Json georeference_json(const geometry::Georeference& g) {
  // a nanodegree is a tenth of a millimetre
  return {{"latitude_deg", rounded(g.latitude_deg, 1e9)},
          {"longitude_deg", rounded(g.longitude_deg, 1e9)},
          {"altitude_m", millimetres(g.altitude_m)},
          {"x_m", millimetres(g.x_m)},
          {"y_m", millimetres(g.y_m)},
          {"yaw_rad", rounded(g.yaw_rad, 1e9)},
          {"residual_rms_m", millimetres(g.residual_rms_m)},
          {"epsg", geometry::utm_epsg(g)}};
}

/// The hash as text: most readers parse JSON numbers as doubles.
std::string hash_text(std::int64_t hash) {
  return fmt::format("{:016x}", static_cast<std::uint64_t>(hash));
}

}  // namespace

std::string residual_warning(const geometry::Georeference& georeference) {
  return "the georeference of the map is doubtful: GNSS fixes deviate by " +
         fixed_text(georeference.residual_rms_m, 2) +
         " m (RMS) from their positions in the map, but at most " +
         fixed_text(geometry::kGeoreferenceResidualMax_m, 1) + " m are expected";
}

std::string summary_json(const MapFolderContent& content) {
  const MapSummary& summary = content.summary;
  Json json;
  json["source"] = summary.source;
  json["version"] = summary.version;
  json["config_hash"] = hash_text(summary.config_hash);
  json["first_utime_us"] = summary.first_utime;
  json["last_utime_us"] = summary.last_utime;
  json["landmarks"]["total"] = content.landmarks.size();
  json["landmarks"]["tree"] = count_of(content, detection::Label::kTree);
  json["landmarks"]["object"] = count_of(content, detection::Label::kObject);
  json["landmarks"]["unseen"] = count_of(content, detection::Label::kUnseen);
  if (content.tree_scatter_m) json["tree_scatter_m"] = millimetres(*content.tree_scatter_m);
  json["rows"] = Json::array();
  for (const mapping::Row& row : content.rows) {
    const auto gaps = std::count_if(row.places.begin(), row.places.end(),
                                    [](const auto& place) { return place.landmark_id == 0; });
    json["rows"].push_back({{"row", row.number},
                            {"trees", static_cast<std::int64_t>(row.places.size()) - gaps},
                            {"gaps", gaps},
                            {"spacing_m", millimetres(row.spacing_m)},
                            {"spacing_sd_m", millimetres(mapping::row_spacing(row).sd_m)}});
  }
  json["path"]["num_poses"] = content.trajectory.size();
  json["path"]["length_m"] = millimetres(path_length_m(content.trajectory));
  json["next_id"] = next_id(content);
  if (content.view) json["view"] = view_json(*content.view);
  if (content.georeference) json["georeference"] = georeference_json(*content.georeference);
  for (const DegradedInterval& stretch : content.degraded) {
    Json entry{{"missing", stretch.missing},
               {"first_utime_us", stretch.first_utime},
               {"last_utime_us", stretch.last_utime}};
    if (stretch.last_id >= stretch.first_id) {
      entry["first_landmark"] = stretch.first_id;
      entry["last_landmark"] = stretch.last_id;
    }
    json["degraded"].push_back(std::move(entry));
  }
  json["counts"] = Json::object();
  for (const auto& [name, count] : summary.counts) json["counts"][name] = count;
  json["warnings"] = summary.warnings;
  if (content.georeference &&
      content.georeference->residual_rms_m > geometry::kGeoreferenceResidualMax_m) {
    json["warnings"].push_back(residual_warning(*content.georeference));
  }
  // Names from outside may be invalid UTF-8, which must not prevent writing the map.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace orchard::io
