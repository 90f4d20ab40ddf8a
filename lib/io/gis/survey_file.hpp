// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "geometry/georeference.hpp"
#include "io/gis/plan_file.hpp"

namespace orchard::io {

/// A point of a survey: a trunk, a post, nobody says which.
struct SurveyPoint {
  std::string row, tree;  ///< empty: no name
  Eigen::Vector2d p_m{0, 0};
  double sd_m = 0.0;  ///< of the position, on each axis; 0: not stated
};

/// Measured points, read from a file.
struct StoredSurvey {
  std::string name;  ///< file name, for messages
  std::vector<SurveyPoint> points;
  /// Pose of the points' frame, as in StoredPlan. None: the file's own flat frame in metres.
  std::optional<geometry::Georeference> georeference;
  std::vector<std::string> notes;  ///< decisions made while reading, one sentence each
};

/// Reads a survey: all points of the files that read_plan() takes, rows or none, classes or none.
/// Throws FileError naming the file, the feature and the remedy; also for two points in one place,
/// for a file without points, and for one with lines beside them.
StoredSurvey read_survey(const std::string& path, const PlanFileOptions& options);

/// derived: no block is this large; a point farther from its middle or datum is a mistake [m].
inline constexpr double kFarthestInBlock_m = 20000.0;

/// Throws FileError naming two features in one place, within a centimetre.
void require_apart(const StoredSurvey& survey);

/// The points' places in the frame x east, y north of a datum; those of a survey without a
/// georeference stay. Throws FileError for a survey far from the datum, and tells whether exchanged
/// latitude and longitude are the cause.
StoredSurvey survey_about(StoredSurvey survey, const geometry::Georeference& datum);

/// A survey as a table: `x_m,y_m,sd_m,row,tree`, where sd_m is empty if it is not stated.
std::string survey_csv(const StoredSurvey& survey);

}  // namespace orchard::io
