// SPDX-License-Identifier: BSD-3-Clause
#include "io/gis/plan_file.hpp"

#include <utility>

#include "io/file_error.hpp"
#include "io/gis/plan_features.hpp"
#include "io/gis/survey_file.hpp"
#include "mapping/plan/orchard_plan.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

using Eigen::Vector2d;

constexpr double kLocalMax_m = 100000.0;

/// Middle of the bounding box of all points. For a block across the date line it is far away, which
/// to_metres() reports.
Vector2d middle_of(const PlanFeatures& features) {
  Vector2d low(1e300, 1e300), high(-1e300, -1e300);
  for (const auto* list : {&features.trees, &features.lines}) {
    for (const PlanFeature& f : *list) {
      for (const Vector2d& p : f.points) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
      }
    }
  }
  return 0.5 * (low + high);
}

/// Converts degrees to metres about the middle; returns this georeference. Throws FileError for
/// points too far from it.
std::optional<geometry::Georeference> to_metres(PlanFeatures& features, const std::string& name) {
  const Vector2d middle = middle_of(features);
  std::optional<geometry::Georeference> georeference;
  if (features.is_geographic) {
    georeference.emplace();
    georeference->longitude_deg = middle.x();
    georeference->latitude_deg = middle.y();
  }
  for (auto* list : {&features.trees, &features.lines}) {
    for (PlanFeature& f : *list) {
      for (Vector2d& p : f.points) {
        if (georeference) p = geometry::map_of(*georeference, {p.y(), p.x()});
        const Vector2d from_middle = georeference ? p : Vector2d(p - middle);
        if (from_middle.norm() > kFarthestInBlock_m) {
          throw FileError(name + ": row " + f.row + " is " +
                          fixed_text(1e-3 * from_middle.norm(), 0) +
                          " km from the middle of the plan; check its coordinate system (--crs)");
        }
        if (!georeference && p.cwiseAbs().maxCoeff() > kLocalMax_m) {
          throw FileError(name + ": x " + fixed_text(p.x(), 1) + ", y " + fixed_text(p.y(), 1) +
                          " are coordinates of a national or UTM system that the file does not "
                          "name; give it, for example --crs EPSG:25830");
        }
      }
    }
  }
  return georeference;
}

mapping::BuiltPlan built(PlanFeatures features, const PlanFileOptions& options,
                         const std::string& name) {
  if (!features.trees.empty()) {
    if (!features.lines.empty()) {
      features.notes.push_back("the plan has trees, so its " +
                               std::to_string(features.lines.size()) + " lines were ignored");
    }
    std::vector<mapping::LoosePlannedTree> trees;
    for (PlanFeature& f : features.trees) {
      trees.push_back({std::move(f.row), std::move(f.tree), f.points.front()});
    }
    mapping::BuiltPlan plan = mapping::plan_of_trees(trees);
    plan.notes.insert(plan.notes.begin(), features.notes.begin(), features.notes.end());
    return plan;
  }
  if (features.lines.empty()) {
    throw FileError(name + " has neither points (trees) nor lines (rows)");
  }
  if (options.spacing_m <= 0.0) {
    throw FileError(
        name +
        " has rows as lines; give the distance between the trees, for example --spacing 3.0");
  }
  std::vector<mapping::PlannedLine> lines;
  for (PlanFeature& f : features.lines) lines.push_back({std::move(f.row), std::move(f.points)});
  mapping::BuiltPlan plan = mapping::plan_of_lines(lines, options.spacing_m);
  plan.notes.insert(plan.notes.begin(), features.notes.begin(), features.notes.end());
  return plan;
}

}  // namespace

StoredSurvey read_survey(const std::string& path, const PlanFileOptions& options) {
  StoredSurvey survey;
  survey.name = path;
  PlanFeatures features = read_plan_features(path, options);
  if (features.trees.empty() || !features.lines.empty()) {
    throw FileError(path +
                    (features.trees.empty() ? " has no points" : " has lines beside points") +
                    "; a survey has one point for each trunk or post");
  }
  survey.georeference = to_metres(features, path);
  survey.notes = std::move(features.notes);
  for (PlanFeature& f : features.trees) {
    survey.points.push_back({std::move(f.row), std::move(f.tree), f.points.front(), f.sd_m});
  }
  require_apart(survey);
  return survey;
}

StoredPlan read_plan(const std::string& path, const PlanFileOptions& options) {
  PlanFeatures features = read_plan_features(path, options);
  StoredPlan stored;
  stored.name = path;
  stored.format = features.format;
  stored.crs = features.crs;
  stored.georeference = to_metres(features, path);
  mapping::BuiltPlan plan = built(std::move(features), options, path);
  if (!plan.problems.empty()) {
    std::string text;
    for (const std::string& problem : plan.problems) text += (text.empty() ? "" : "; ") + problem;
    throw FileError(path + ": " + text +
                    "; correct the plan, or name its columns with --row-field and --tree-field");
  }
  stored.plan = std::move(plan.plan);
  stored.notes = std::move(plan.notes);
  return stored;
}

mapping::OrchardPlan plan_in_map(const StoredPlan& plan, const geometry::Georeference& of_map) {
  mapping::OrchardPlan result = plan.plan;
  if (!plan.georeference) return result;
  for (mapping::PlannedRow& row : result.rows) {
    for (mapping::PlannedTree& tree : row.trees) {
      tree.p_plan =
          geometry::map_of(of_map, geometry::geodetic_of(*plan.georeference, tree.p_plan));
    }
  }
  return result;
}

}  // namespace orchard::io
