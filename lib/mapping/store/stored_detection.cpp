// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/store/stored_detection.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::mapping {

using detection::Detection;

Observation observation_of(const Candidate& candidate) {
  const Detection& d = *candidate.detection;
  Observation o;
  o.x_base_m = static_cast<float>(d.centre_x_m);
  o.y_base_m = static_cast<float>(d.centre_y_m);
  o.sd_m = static_cast<float>(std::sqrt(0.5 * candidate.covariance.trace()));
  o.roc_tree = static_cast<float>(d.roc_tree);
  o.width_m = static_cast<float>(d.width_m);
  o.width_sd_m = static_cast<float>(d.width_sd_m);
  o.covariance_xx = static_cast<float>(d.covariance[0]);
  o.covariance_xy = static_cast<float>(d.covariance[1]);
  o.covariance_yy = static_cast<float>(d.covariance[2]);
  o.probability_tree = d.probability_tree;
  o.probability_object = d.probability_object;
  o.label = static_cast<std::int8_t>(d.label);
  o.occlusion = d.occlusion;
  o.num_beams = static_cast<std::uint8_t>(std::clamp(d.num_beams, 0, 255));
  return o;
}

Detection detection_of(const Observation& o) {
  Detection d;
  d.centre_x_m = o.x_base_m;
  d.centre_y_m = o.y_base_m;
  d.covariance = {o.covariance_xx, o.covariance_xy, o.covariance_yy};
  d.width_m = o.width_m;
  d.width_sd_m = o.width_sd_m;
  d.roc_tree = o.roc_tree;
  d.probability_tree = o.probability_tree;
  d.probability_object = o.probability_object;
  d.label = static_cast<detection::Label>(o.label);
  d.occlusion = o.occlusion;
  d.num_beams = o.num_beams;
  return d;
}

}  // namespace orchard::mapping
