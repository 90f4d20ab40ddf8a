// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/object_landmarks.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "geometry/statistics.hpp"

namespace orchard::calibration {
namespace {

detection::Label label_of(const ObservedObject& seen) {
  if (seen.is_trunk) return detection::Label::kTree;
  return seen.is_doubtful ? detection::Label::kUnseen : detection::Label::kObject;
}

}  // namespace

std::vector<mapping::Landmark> object_landmarks(const TrunkModel& model,
                                                const std::vector<TrunkObservation>& observations,
                                                int log) {
  std::vector<mapping::Landmark> landmarks;
  for (std::size_t object = 0; object < model.objects.size(); ++object) {
    const ObservedObject& seen = model.objects[object];
    if (seen.log != log || seen.observations.empty()) continue;
    if (!observations[seen.observations.front()].in_map) continue;
    mapping::Landmark landmark;
    landmark.id = static_cast<std::int32_t>(object) + 1;
    landmark.label = label_of(seen);
    landmark.num_observations = seen.num_observations;
    landmark.x_m = seen.x_m;
    landmark.y_m = seen.y_m;
    landmark.width_m = seen.median_width_m;
    double squares_x_m2 = 0.0, squares_y_m2 = 0.0;
    for (const std::size_t i : seen.observations) {
      squares_x_m2 += geometry::square(observations[i].x_m - seen.x_m);
      squares_y_m2 += geometry::square(observations[i].y_m - seen.y_m);
    }
    const double n = seen.num_observations;
    landmark.se_x_m = std::sqrt(squares_x_m2 / std::max(1.0, n - 1.0) / n);
    landmark.se_y_m = std::sqrt(squares_y_m2 / std::max(1.0, n - 1.0) / n);
    landmarks.push_back(landmark);
  }
  return landmarks;
}

}  // namespace orchard::calibration
