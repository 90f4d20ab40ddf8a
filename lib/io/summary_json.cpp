// SPDX-License-Identifier: BSD-3-Clause
#include "io/summary_json.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <nlohmann/json.hpp>

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

/// JSON's numbers are doubles to most readers: a hash is text.
std::string hash_text(std::int64_t hash) {
  char text[20];
  std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

}  // namespace

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
  json["rows"] = Json::array();
  for (const mapping::Row& row : content.rows) {
    const auto gaps = std::count_if(row.places.begin(), row.places.end(),
                                    [](const auto& place) { return place.landmark_id == 0; });
    json["rows"].push_back({{"row", row.number},
                            {"trees", static_cast<std::int64_t>(row.places.size()) - gaps},
                            {"gaps", gaps},
                            {"spacing_m", std::round(row.spacing_m * 1e3) / 1e3}});
  }
  json["path"]["num_poses"] = content.trajectory.size();
  // to the millimetre, as everything that is written here
  json["path"]["length_m"] = std::round(path_length_m(content.trajectory) * 1e3) / 1e3;
  json["counts"] = Json::object();
  for (const auto& [name, count] : summary.counts) json["counts"][name] = count;
  json["warnings"] = summary.warnings;
  // Names from outside may hold anything; what is no UTF-8 must not stop the map.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace orchard::io
