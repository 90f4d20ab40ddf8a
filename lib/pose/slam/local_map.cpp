// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/local_map.hpp"

#include <algorithm>
#include <utility>

namespace orchard::pose {
namespace {

constexpr double kTrackedTravelM = 3.0;  // what was seen within is being tracked

using Interval = std::pair<double, double>;  // of travel [m]

/// The stretches of path on which something that is tracked now was seen, widened.
std::vector<Interval> tracked_stretches(const SlamGraph& graph, int since, double margin_m) {
  const std::vector<Keyframe>& keyframes = graph.keyframes;
  std::vector<int> seen;
  for (int k = static_cast<int>(keyframes.size()) - 1; k >= since; --k) {
    if (keyframes.back().travel_m - keyframes[k].travel_m > kTrackedTravelM) break;
    for (const SlamSighting& s : keyframes[k].sightings) seen.push_back(s.landmark);
  }
  std::sort(seen.begin(), seen.end());
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  std::vector<Interval> stretches;
  for (const int l : seen) {
    if (!graph.landmarks[l].confirmed) continue;
    for (const int k : graph.landmarks[l].keyframes) {
      stretches.emplace_back(keyframes[k].travel_m - margin_m, keyframes[k].travel_m + margin_m);
    }
  }
  std::sort(stretches.begin(), stretches.end());
  std::vector<Interval> joined;
  for (const Interval& s : stretches) {
    if (!joined.empty() && s.first <= joined.back().second) {
      joined.back().second = std::max(joined.back().second, s.second);
    } else {
      joined.push_back(s);
    }
  }
  return joined;
}

bool seen_on(const SlamGraph& graph, const SlamLandmark& landmark,
             const std::vector<Interval>& stretches) {
  auto stretch = stretches.begin();
  for (const int k : landmark.keyframes) {
    const double travel_m = graph.keyframes[k].travel_m;
    while (stretch != stretches.end() && stretch->second < travel_m) ++stretch;
    if (stretch == stretches.end()) return false;
    if (stretch->first <= travel_m) return true;
  }
  return false;
}

}  // namespace

std::vector<int> local_map(const SlamGraph& graph, const SlamLandmarkIndex& index, int since,
                           double radius_m, const SlamConfig& config) {
  std::vector<int> found;
  if (graph.keyframes.empty()) return found;
  const Keyframe& now = graph.keyframes.back();
  const std::vector<Interval> stretches =
      tracked_stretches(graph, since, config.covisible_travel_m);
  for (const int l : index.near(now.T_map_base.head<2>(), radius_m)) {
    const SlamLandmark& landmark = graph.landmarks[l];
    if (!landmark.alive || landmark.keyframes.empty()) continue;
    const int last = landmark.keyframes.back();
    const bool recent =
        last >= since && now.travel_m - graph.keyframes[last].travel_m <= config.recent_travel_m;
    if (recent || (landmark.confirmed && seen_on(graph, landmark, stretches))) found.push_back(l);
  }
  return found;
}

}  // namespace orchard::pose
