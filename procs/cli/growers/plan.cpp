// SPDX-License-Identifier: BSD-3-Clause
#include "cli/growers/report.hpp"

#include <fmt/core.h>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "bus/process/process.hpp"
#include "cli/maps/maps.hpp"
#include "cli/maps/stored_maps.hpp"
#include "geometry/angles.hpp"
#include "io/atomic_file.hpp"
#include "io/file_error.hpp"
#include "io/gis/plan_file.hpp"
#include "io/gis/plan_report.hpp"
#include "io/gis/survey_file.hpp"
#include "io/map/map_folder.hpp"
#include "mapping/plan/plan_match.hpp"
#include "mapping/rows/row_numbers.hpp"
#include "text/encoded_text.hpp"

namespace orchard::cli {
namespace {

using mapping::PlanDeviation;
using mapping::PlanFinding;

constexpr int kLinesMax = 60;

/// A plan registered to a map.
struct RegisteredPlan {
  io::StoredPlan plan;  ///< in the map frame, where both are georeferenced
  mapping::PlanMatch match;
  bool is_georeferenced_by_plan = false;  ///< the map had no georeference and gets the plan's
};

std::size_t index_of(PlanDeviation deviation) { return static_cast<std::size_t>(deviation); }

/// Describes a placement so that a person in the orchard can recognise it.
std::string placement_text(const io::StoredPlan& plan, const io::StoredMap& map,
                           const geometry::Pose2& T_map_plan) {
  const geometry::IndexedPoints places(plan.plan.places());
  const bool has_path = !map.trajectories.empty();
  const Eigen::Vector2d p_map =
      has_path ? Eigen::Vector2d(map.trajectories.front().front().x_m,
                                 map.trajectories.front().front().y_m)
               : Eigen::Vector2d(map.landmarks.front().x_m, map.landmarks.front().y_m);
  const Eigen::Vector2d p_plan = inverse_transform(T_map_plan, p_map);
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < places.size(); ++i) {
    if ((places[i] - p_plan).norm() < (places[nearest] - p_plan).norm()) nearest = i;
  }
  const mapping::PlanIndex at = mapping::plan_indices(plan.plan)[nearest];
  const mapping::PlannedRow& row = plan.plan.rows[static_cast<std::size_t>(at.row)];
  return (has_path ? "the drive started "
                   : "landmark " + std::to_string(map.landmarks.front().id) + " is ") +
         fmt::format("{:.1f} m from row {} tree {}", (places[nearest] - p_plan).norm(), row.name,
                     row.trees[static_cast<std::size_t>(at.tree)].name);
}

[[noreturn]] void refuse(const io::StoredPlan& plan, const io::StoredMap& map,
                         const mapping::PlanMatch& match, bool any_place) {
  const std::string begin = plan.name + " cannot be registered to " + map.name;
  if (match.fit.status != mapping::AlignmentStatus::kAmbiguous) {
    throw io::FileError(begin + ": " + match.fit.reason +
                        (any_place
                             ? "; are plan and map of the same orchard?"
                             : "; are plan and map of the same orchard, and is the coordinate "
                               "system right? If the positions are unrelated, use --any-place"));
  }
  std::string text = begin + ", the result is ambiguous: " + match.fit.reason;
  for (std::size_t k = 0; k < match.fit.placements.size(); ++k) {
    text += fmt::format("\n  --placement {}: {}", k + 1,
                        placement_text(plan, map, match.fit.placements[k].T_map_plan));
  }
  throw io::FileError(text +
                      "\n"
                      "choose the true one with --placement");
}

std::string line_of(const RegisteredPlan& laid, const PlanFinding& f,
                    const std::vector<mapping::Landmark>& landmarks) {
  std::string row = "-", tree = "-", detail;
  if (f.row >= 0) {
    const mapping::PlannedRow& planned = laid.plan.plan.rows[static_cast<std::size_t>(f.row)];
    row = planned.name;
    if (f.tree >= 0) tree = planned.trees[static_cast<std::size_t>(f.tree)].name;
  }
  if (f.deviation == PlanDeviation::kExtra && tree != "-") tree = "after " + tree;
  const std::string id =
      f.landmark < 0 ? "-" : std::to_string(landmarks[static_cast<std::size_t>(f.landmark)].id);
  if (f.deviation == PlanDeviation::kOutOfPlace) {
    detail = fmt::format("{:+.2f} m along the row, {:+.2f} m across", f.along_m, f.aside_m);
  } else if (f.deviation == PlanDeviation::kMissing) {
    detail = f.landmark < 0 ? "" : "an object is at this position";
  }
  return fmt::format("{:<12}  {:>8}  {:>10}  {:>6}  {:9.2f}  {:9.2f}  {}\n",
                     mapping::deviation_text(f.deviation), row, tree, id, f.p_map.x(), f.p_map.y(),
                     detail);
}

/// Matches a plan's trees with a map. If both are georeferenced, the registration starts from that,
/// within the limits of `config`; otherwise it is unconstrained. Throws io::FileError in one
/// sentence when the registration fails, with all matching placements when it is ambiguous.
RegisteredPlan register_plan(const io::StoredPlan& plan, const io::StoredMap& map,
                             mapping::PlanMatchConfig config) {
  RegisteredPlan laid;
  laid.plan = plan;
  if (plan.georeference && map.georeference) {
    laid.plan.plan = io::plan_in_map(plan, *map.georeference);
  } else {
    config.alignment.any_place = true;
    laid.is_georeferenced_by_plan = plan.georeference.has_value();
  }
  laid.match = mapping::match_plan(laid.plan.plan, map.landmarks, view_of(map, 0.0), config);
  if (!laid.match.is_registered()) refuse(laid.plan, map, laid.match, config.alignment.any_place);
  return laid;
}

/// Writes the plan's numbers, names and rows into the content of a map folder, and the plan's
/// georeference where the map has none; lists the differences from the plan in its summary.
void apply_plan(const RegisteredPlan& laid, io::MapFolderContent& content) {
  content.plan_names = mapping::number_by_plan(laid.plan.plan, laid.match, content.landmarks);
  content.rows = mapping::numbered_rows(content.landmarks);
  if (laid.is_georeferenced_by_plan) {
    geometry::Georeference g = *laid.plan.georeference;
    const geometry::Pose2 T_plan_map = inverse(laid.match.T_map_plan());
    g.x_m = T_plan_map.x_m;
    g.y_m = T_plan_map.y_m;
    g.yaw_rad = T_plan_map.yaw_rad;
    g.residual_rms_m = laid.match.rms_m;
    content.georeference = g;
  }
  for (int k = 0; k < mapping::kNumPlanDeviations; ++k) {
    content.summary.counts.push_back(
        {std::string("plan_") + mapping::deviation_text(static_cast<PlanDeviation>(k)),
         laid.match.counts[static_cast<std::size_t>(k)]});
  }
}

/// Writes plan.csv, plan_rows.csv and plan.json beside a map. Throws io::FileError.
void write_plan_files(const std::string& folder, const RegisteredPlan& laid,
                      const std::vector<mapping::Landmark>& landmarks) {
  const io::PlanReport report{laid.plan, landmarks, laid.match};
  io::FileReplacement files;
  files.write(folder + "/plan.csv", io::plan_csv(report));
  files.write(folder + "/plan_rows.csv", io::plan_rows_csv(report));
  files.write(folder + "/plan.json", io::plan_match_json(report));
  files.commit();
}

/// Prints the match for the user: a line for each row, then the deviations.
void print_match(const RegisteredPlan& laid, const std::vector<mapping::Landmark>& landmarks) {
  const mapping::PlanMatch& match = laid.match;
  const geometry::Pose2& T = match.T_map_plan();
  std::printf("registered to the map on %d trees with a residual of %.2f m (RMS)",
              match.counts[index_of(PlanDeviation::kAsPlanned)] +
                  match.counts[index_of(PlanDeviation::kOutOfPlace)],
              match.rms_m);
  if (laid.is_georeferenced_by_plan) {
    std::printf("; the map takes its georeference from the plan\n");
  } else {
    std::printf("; the plan is offset by %.2f m and rotated by %.2f degrees\n",
                std::hypot(T.x_m, T.y_m), T.yaw_rad * 180.0 / geometry::kPi);
  }
  std::printf("\n     row  planned  as planned  out of place  missing  not seen  extra\n");
  for (std::size_t r = 0; r < match.rows.size(); ++r) {
    const mapping::PlanRowFinding& row = match.rows[r];
    const auto count = [&row](PlanDeviation d) { return row.counts[index_of(d)]; };
    std::printf("%8s  %7zu  %10d  %12d  %7d  %8d  %5d", laid.plan.plan.rows[r].name.c_str(),
                laid.plan.plan.rows[r].trees.size(), count(PlanDeviation::kAsPlanned),
                count(PlanDeviation::kOutOfPlace), count(PlanDeviation::kMissing),
                count(PlanDeviation::kNotSeen), count(PlanDeviation::kExtra));
    if (row.is_shifted) {
      std::printf("  the row is shifted by %+.2f m along, %+.2f m across", row.shift.along_m,
                  row.shift.aside_m);
    }
    std::printf("\n");
  }
  int num_lines = 0;
  for (const PlanDeviation deviation :
       {PlanDeviation::kMissing, PlanDeviation::kOutOfPlace, PlanDeviation::kExtra}) {
    for (const PlanFinding& f : match.findings) {
      if (f.deviation != deviation || num_lines >= kLinesMax) continue;
      if (num_lines++ == 0) {
        std::printf("\ndeviation          row        tree      id          x          y\n");
      }
      std::fputs(line_of(laid, f, landmarks).c_str(), stdout);
    }
  }
  if (num_lines >= kLinesMax) std::printf("... more in plan.csv (--out DIR)\n");
}

void print_plan(const io::StoredPlan& plan) {
  std::printf("%s: %s, %s: %zu rows, %zu trees, rows %.2f m apart%s\n", plan.name.c_str(),
              plan.format.c_str(), plan.crs.c_str(), plan.plan.rows.size(), plan.plan.num_trees(),
              mapping::typical_aisle_m(plan.plan), plan.georeference ? "" : "; not georeferenced");
  std::printf(
      "\n"
      "     row  trees  first ... last      length_m  spacing_m (min, max)\n");
  for (const mapping::PlannedRow& row : plan.plan.rows) {
    const mapping::PlannedRowFacts facts = mapping::row_facts(row);
    std::printf("%8s  %5zu  %8s ... %-8s  %8.1f  %9.2f (%.2f, %.2f)\n", row.name.c_str(),
                row.trees.size(), row.trees.front().name.c_str(), row.trees.back().name.c_str(),
                facts.length_m, facts.spacing_m, facts.spacing_min_m, facts.spacing_max_m);
  }
}

int look_at(const io::StoredPlan& plan, const PlanOptions& options) {
  if (!options.out_path.empty()) {
    io::write_file_atomically(options.out_path, io::plan_geojson(plan));
  }
  if (options.json) {
    std::fputs(io::plan_json(plan).c_str(), stdout);
    return bus::kExitOk;
  }
  print_plan(plan);
  if (!options.out_path.empty()) std::printf("\nwritten to %s\n", options.out_path.c_str());
  return bus::kExitOk;
}

/// Prints the points as they are, without looking for rows.
int print_points(const PlanOptions& options) {
  io::StoredSurvey survey = io::read_survey(options.plan_path, options.file);
  for (const std::string& note : survey.notes) {
    std::fprintf(stderr, "orchard plan: note: %s\n", note.c_str());
  }
  if (!options.datum_deg.empty()) {
    geometry::Georeference datum;
    datum.latitude_deg = options.datum_deg[0];
    datum.longitude_deg = options.datum_deg[1];
    survey = io::survey_about(std::move(survey), datum);
  }
  std::fputs(io::survey_csv(survey).c_str(), stdout);
  return bus::kExitOk;
}

io::PlanCounts counts_of_plan(const ReportOptions& options, const io::StoredMap& map) {
  const io::StoredPlan plan = io::read_plan(options.plan_path, options.plan_file);
  const RegisteredPlan laid = register_plan(plan, map, options.plan_match);
  io::PlanCounts counts;
  counts.name = printable_text(std::filesystem::path(options.plan_path).filename().string());
  for (std::size_t i = 0; i < laid.match.rows.size(); ++i) {
    const mapping::PlanRowFinding& row = laid.match.rows[i];
    counts.rows.push_back(
        {printable_text(laid.plan.plan.rows.at(i).name), row.counts, row.is_shifted});
  }
  return counts;
}

}  // namespace

int run_plan(const PlanOptions& options) {
  if (options.csv) return print_points(options);
  const io::StoredPlan plan = io::read_plan(options.plan_path, options.file);
  for (const std::string& note : plan.notes) {
    std::fprintf(stderr, "orchard plan: note: %s\n", note.c_str());
  }
  if (options.map_path.empty()) return look_at(plan, options);
  const io::StoredMap map = io::read_stored_map(options.map_path);
  if (!options.out_path.empty()) require_other_folder(options.out_path, {options.map_path});
  const RegisteredPlan laid = register_plan(plan, map, options.match);
  if (!options.out_path.empty()) {
    io::MapFolderContent content = content_of(map);
    content.summary.source = "numbered by a plan";
    apply_plan(laid, content);
    io::write_map_folder(options.out_path, content);
    write_plan_files(options.out_path, laid, content.landmarks);
  }
  if (options.json) {
    std::fputs(io::plan_match_json({laid.plan, map.landmarks, laid.match}).c_str(), stdout);
    return bus::kExitOk;
  }
  print_match(laid, map.landmarks);
  if (!options.out_path.empty()) {
    std::printf(
        "\n"
        "written to %s: the map with the plan's numbers, plan.csv and plan_rows.csv "
        "(differences),\n"
        "  plan.json, names.csv (names of the plan by landmark id)\n",
        options.out_path.c_str());
  }
  return bus::kExitOk;
}

int run_report(const ReportOptions& options) {
  return write_report(
      options, [&options](const io::StoredMap& map) { return counts_of_plan(options, map); });
}

}  // namespace orchard::cli
