// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/local_map.hpp"

#include <algorithm>
#include <utility>

namespace orchard::pose {
namespace {

/// Landmarks observed within this travel of a tracked one are covisible with it, in sight ranges.
constexpr double kCovisibleTravel_ranges = 0.8;

using Interval = std::pair<double, double>;  // of travel [m]

/// Returns the intervals of travel in which landmarks tracked now were observed, plus a margin.
std::vector<Interval> tracked_intervals(const SlamGraph& graph, int session_start, double range_m) {
  const double margin_m = kCovisibleTravel_ranges * range_m;
  const std::vector<Keyframe>& keyframes = graph.keyframes;
  std::vector<int> observed;
  for (int k = static_cast<int>(keyframes.size()) - 1; k >= session_start; --k) {
    if (keyframes.back().travel_m - keyframes[k].travel_m > kTrackedTravel_ranges * range_m) break;
    for (const SlamObservation& s : keyframes[k].observations) observed.push_back(s.landmark);
  }
  std::sort(observed.begin(), observed.end());
  observed.erase(std::unique(observed.begin(), observed.end()), observed.end());
  std::vector<Interval> intervals;
  for (const int l : observed) {
    if (!graph.landmarks[l].confirmed) continue;
    for (const int k : graph.landmarks[l].keyframes) {
      intervals.emplace_back(keyframes[k].travel_m - margin_m, keyframes[k].travel_m + margin_m);
    }
  }
  std::sort(intervals.begin(), intervals.end());
  std::vector<Interval> joined;
  for (const Interval& s : intervals) {
    if (!joined.empty() && s.first <= joined.back().second) {
      joined.back().second = std::max(joined.back().second, s.second);
    } else {
      joined.push_back(s);
    }
  }
  return joined;
}

bool observed_in(const SlamGraph& graph, const SlamLandmark& landmark,
                 const std::vector<Interval>& intervals) {
  auto interval = intervals.begin();
  for (const int k : landmark.keyframes) {
    const double travel_m = graph.keyframes[k].travel_m;
    while (interval != intervals.end() && interval->second < travel_m) ++interval;
    if (interval == intervals.end()) return false;
    if (interval->first <= travel_m) return true;
  }
  return false;
}

}  // namespace

std::vector<int> local_map(const SlamGraph& graph, const geometry::PointGrid& index,
                           int session_start, double range_m, double radius_m) {
  std::vector<int> found;
  if (graph.keyframes.empty()) return found;
  const Keyframe& now = graph.keyframes.back();
  const std::vector<Interval> intervals = tracked_intervals(graph, session_start, range_m);
  for (const int l : index.near(now.T_map_base.head<2>(), radius_m)) {
    const SlamLandmark& landmark = graph.landmarks[l];
    if (!landmark.alive || landmark.keyframes.empty()) continue;
    const int last = landmark.keyframes.back();
    const bool recent = last >= session_start && now.travel_m - graph.keyframes[last].travel_m <=
                                                     kRecentTravel_ranges * range_m;
    if (recent || (landmark.confirmed && observed_in(graph, landmark, intervals)))
      found.push_back(l);
  }
  return found;
}

}  // namespace orchard::pose
