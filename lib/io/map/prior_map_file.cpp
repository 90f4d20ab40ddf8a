// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/prior_map_file.hpp"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <sstream>
#include <system_error>

#include "io/companion.hpp"
#include "io/file_error.hpp"
#include "io/map/map_csv.hpp"
#include "io/map/stored_map.hpp"
#include "mapping/compare/visibility.hpp"
#include "text/number_text.hpp"

namespace orchard::io {

namespace {

/// Position sigma in standard errors of the mean: observations of one pass are correlated, so a
/// single standard error is too optimistic.
constexpr double kStandardErrors = 2.0;

/// Throws FileError when the landmarks are not sufficient for localization.
void require_places(const std::string& name, const std::vector<pose::PriorLandmark>& landmarks) {
  const std::string problem = pose::problem_with(landmarks);
  if (problem.empty()) return;
  throw FileError(name + " (pose.prior_map.map_file) cannot be used for localisation: it " +
                  problem);
}

/// The next number of a line of comma-separated ones; none if there is none there.
std::optional<double> next_number(const char*& at, const char* end) {
  double value = 0.0;
  const auto [after, error] = std::from_chars(at, end, value);
  at = after + (after < end ? 1 : 0);
  if (error != std::errc()) return std::nullopt;
  return value;
}

pose::PriorMapData read_prior_survey(const pose::PoseConfig& config) {
  const std::string& path = config.prior_map.map_file;
  // A name that begins like an option is still a file.
  std::vector<std::string> arguments{"plan", path.rfind('-', 0) == 0 ? "./" + path : path, "--csv"};
  const auto& datum = config.gnss.datum;
  if (datum != decltype(config.gnss.datum){}) {
    for (const std::string& word :
         {std::string("--datum"), fixed_text(datum[0], 10), fixed_text(datum[1], 10)}) {
      arguments.push_back(word);
    }
  }
  std::string text;
  try {
    text = output_of_companion("orchard-gis", arguments);
  } catch (const FileError& error) {
    throw FileError(
        path +
        " (pose.prior_map.map_file) is no map of this program, and as a survey it cannot be "
        "read: " +
        error.what() + "; `orchard plan " + path + " --csv` shows what is read of it");
  }
  pose::PriorMapData survey;
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);  // the names of the columns
  while (std::getline(lines, line)) {
    const char *at = line.data(), *end = line.data() + line.size();
    const std::optional<double> x_m = next_number(at, end), y_m = next_number(at, end);
    const std::optional<double> sd_m = next_number(at, end);  // then row and tree, any text
    if (!x_m || !y_m) {
      throw FileError(path +
                      ": orchard-gis is of another release than this program; install both again");
    }
    pose::PriorLandmark landmark;
    landmark.p_map = {*x_m, *y_m};
    landmark.sd_m = sd_m.value_or(config.prior_map.survey_sd_m);
    survey.landmarks.push_back(landmark);
  }
  require_places(path, survey.landmarks);
  return survey;
}

}  // namespace

pose::PriorMapData read_prior_map(const pose::PoseConfig& pose_config) {
  const pose::PriorMapConfig& config = pose_config.prior_map;
  if (!is_map(config.map_file)) return read_prior_survey(pose_config);
  std::string path = config.map_file;
  std::error_code unknown;
  const bool is_folder = std::filesystem::is_directory(path, unknown);
  if (is_folder) path += "/map.csv";
  pose::PriorMapData earlier;
  std::vector<mapping::Landmark> used;
  for (const mapping::Landmark& l : read_map_csv(path)) {
    if (l.num_observations < config.min_observations) continue;
    pose::PriorLandmark landmark;
    landmark.p_map = {l.x_m, l.y_m};
    landmark.width_m = l.width_m;
    landmark.weight = l.num_observations;
    landmark.sd_m = kStandardErrors * std::hypot(l.se_x_m, l.se_y_m) / std::sqrt(2.0);
    earlier.landmarks.push_back(landmark);
    used.push_back(l);
  }
  require_places(path, earlier.landmarks);
  if (!is_folder) return earlier;
  const StoredMap map = read_stored_map(config.map_file);
  const mapping::DetectionMap view(map.landmarks, map.trajectories, map.view);
  const std::vector<double> rates = view.rates(used);
  for (std::size_t i = 0; i < used.size(); ++i) earlier.landmarks[i].rate = rates[i];
  earlier.seen_m = view.places_seen();
  earlier.cell_m = mapping::VisibilityGrid::kCell_m;
  return earlier;
}

}  // namespace orchard::io
