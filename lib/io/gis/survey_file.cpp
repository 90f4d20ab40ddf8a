// SPDX-License-Identifier: BSD-3-Clause
#include "io/gis/survey_file.hpp"

#include <cmath>

#include "geometry/point_grid.hpp"
#include "io/csv.hpp"
#include "io/file_error.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

constexpr double kOnePoint_m = 0.01;  ///< derived: a survey's resolution; nearer is entered twice

}  // namespace

void require_apart(const StoredSurvey& survey) {
  std::vector<Eigen::Vector2d> places;
  for (const SurveyPoint& point : survey.points) places.push_back(point.p_m);
  const geometry::IndexedPoints all(std::move(places));
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (const std::int32_t j : all.within(all[i], kOnePoint_m)) {
      if (static_cast<std::size_t>(j) <= i) continue;
      throw FileError(survey.name + ": features " + std::to_string(i + 1) + " and " +
                      std::to_string(j + 1) + " are at the same place; delete one");
    }
  }
}

StoredSurvey survey_about(StoredSurvey survey, const geometry::Georeference& datum) {
  if (!survey.georeference) return survey;
  const auto distance_m = [&datum](double latitude_deg, double longitude_deg) {
    return geometry::map_of(datum, {latitude_deg, longitude_deg}).norm();
  };
  const double latitude_deg = survey.georeference->latitude_deg;
  const double longitude_deg = survey.georeference->longitude_deg;
  if (const double away_m = distance_m(latitude_deg, longitude_deg); away_m > kFarthestInBlock_m) {
    const bool is_exchanged = std::abs(longitude_deg) <= 90.0 &&
                              distance_m(longitude_deg, latitude_deg) <= kFarthestInBlock_m;
    throw FileError(survey.name + " is " + fixed_text(1e-3 * away_m, 0) + " km from the datum " +
                    fixed_text(datum.latitude_deg, 4) + ", " + fixed_text(datum.longitude_deg, 4) +
                    (is_exchanged ? ": its latitudes and longitudes are exchanged; GeoJSON has "
                                    "longitude first"
                                  : "; is it the survey of this orchard, and is the datum right "
                                    "(latitude, longitude)?"));
  }
  for (SurveyPoint& point : survey.points) {
    point.p_m = geometry::map_of(datum, geometry::geodetic_of(*survey.georeference, point.p_m));
  }
  survey.georeference = datum;
  return survey;
}

std::string survey_csv(const StoredSurvey& survey) {
  std::string text = "x_m,y_m,sd_m,row,tree\n";
  for (const SurveyPoint& point : survey.points) {
    text += fixed_text(point.p_m.x(), 4) + "," + fixed_text(point.p_m.y(), 4) + "," +
            (point.sd_m > 0.0 ? fixed_text(point.sd_m, 4) : "") + "," + csv_field(point.row) + "," +
            csv_field(point.tree) + "\n";
  }
  return text;
}

}  // namespace orchard::io
