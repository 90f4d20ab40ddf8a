// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/windows/window_evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "geometry/statistics.hpp"
#include "vision/appearance.hpp"

namespace orchard::evaluation {

vision::PixelBlock exposed(const vision::PixelBlock& pixels, double exposure_ev) {
  vision::PixelBlock result = pixels;
  const auto curve = vision::exposure_curve(std::exp2(exposure_ev));
  for (std::uint8_t& value : result.bgr) value = curve[value];
  return result;
}

namespace {

constexpr int kDraws = 500;
constexpr std::uint64_t kSeed = 20131;

/// The windows of one group.
using Group = std::vector<const ScoredWindow*>;
using Score = double ScoredWindow::*;

double area_of(const std::vector<const Group*>& groups, Score score) {
  std::vector<double> trunk, other;
  for (const Group* group : groups) {
    for (const ScoredWindow* window : *group) {
      (window->is_trunk ? trunk : other).push_back(window->*score);
    }
  }
  return geometry::roc_area(trunk, other);
}

AreaEstimate estimate(const std::vector<Group>& groups, Score score) {
  std::vector<const Group*> drawn;
  for (const Group& group : groups) drawn.push_back(&group);
  AreaEstimate result;
  result.area = area_of(drawn, score);
  std::mt19937_64 random(kSeed);
  std::vector<double> areas;
  for (int i = 0; i < kDraws; ++i) {
    for (const Group*& group : drawn) group = &groups[random() % groups.size()];
    areas.push_back(area_of(drawn, score));
  }
  std::sort(areas.begin(), areas.end());
  result.low = areas[kDraws * 25 / 1000];
  result.high = areas[kDraws * 975 / 1000];
  return result;
}

}  // namespace

WindowEvaluation evaluate_windows(const std::vector<ScoredWindow>& windows, double confidence_min) {
  WindowEvaluation result;
  result.confidence_min = confidence_min;
  std::map<int, Group> by_group;
  for (const ScoredWindow& window : windows) {
    by_group[window.group].push_back(&window);
    ++(window.is_trunk ? result.num_trunk : result.num_other);
    if (window.appearance >= confidence_min) {
      (window.is_trunk ? result.found_fraction : result.false_fraction) += 1.0;
    }
  }
  result.found_fraction /= std::max(1, result.num_trunk);
  result.false_fraction /= std::max(1, result.num_other);
  result.num_groups = static_cast<int>(by_group.size());
  if (by_group.empty()) return result;
  std::vector<Group> groups;
  for (auto& [number, group] : by_group) groups.push_back(std::move(group));
  result.appearance = estimate(groups, &ScoredWindow::appearance);
  result.hue_interval = estimate(groups, &ScoredWindow::hue_interval);
  result.paper_hue_interval = estimate(groups, &ScoredWindow::paper_hue_interval);
  return result;
}

std::string window_json(const WindowEvaluation& e) {
  const auto interval = [](const AreaEstimate& a) { return nlohmann::json{a.low, a.high}; };
  const nlohmann::ordered_json json{{"auc", e.appearance.area},
                                    {"auc_interval", interval(e.appearance)},
                                    {"auc_hue_interval", e.hue_interval.area},
                                    {"auc_hue_interval_interval", interval(e.hue_interval)},
                                    {"auc_hue_interval_paper", e.paper_hue_interval.area},
                                    {"pictures", e.num_pictures},
                                    {"trees", e.num_groups},
                                    {"windows_on_trunks", e.num_trunk},
                                    {"windows_elsewhere", e.num_other},
                                    {"confidence_min", e.confidence_min},
                                    {"found_share", e.found_fraction},
                                    {"false_share", e.false_fraction}};
  return json.dump(2) + "\n";
}

}  // namespace orchard::evaluation
