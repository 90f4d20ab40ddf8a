// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibration/trunks/probability_learner.hpp"
#include "calibration/trunks/trunk_model.hpp"
#include "geometry/point_grid.hpp"
#include "mapping/candidate.hpp"
#include "mapping/landmark.hpp"
#include "mapping/mapper_config.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::calibration {

/// The landmark that a detection belongs to.
struct LandmarkMatch {
  int landmark = -1;         ///< index in the map; -1 = none
  bool is_doubtful = false;  ///< it may belong to a tree or to something else
};

/// Finds the landmarks of a finished map that detections belong to, by position alone.
///
/// Unlike mapping::associate(), neither width nor class of the detection counts, because the
/// outcome must not depend on the features whose weights are learnt from it. A landmark's reach is
/// mapper.gate_m, or half its width (at most half of object_width_max_m) if that is more, about its
/// centre line. Within it, the landmarks nearer than mapper.gate_sigma standard deviations of the
/// detection and of the landmark's observations (its standard error times the root of their number)
/// come before all others; distances count from the landmark's border. If these are not all of one
/// class, the detection is doubtful, else it belongs to the nearest.
class LandmarkOutcomes {
 public:
  LandmarkOutcomes(std::vector<mapping::Landmark> landmarks, const mapping::MapperConfig& config);

  /// One match per detection of a scan. A tree keeps only the nearest detection of a scan; the
  /// others match nothing.
  std::vector<LandmarkMatch> match(const std::vector<mapping::Candidate>& scan) const;

  const std::vector<mapping::Landmark>& landmarks() const { return landmarks_; }

 private:
  LandmarkMatch match(const mapping::Candidate& candidate, double& distance_m) const;

  std::vector<mapping::Landmark> landmarks_;
  mapping::MapperConfig config_;
  double reach_max_m_ = 0.0;
  std::vector<Eigen::Vector2d> places_map_;  ///< along the centre lines
  std::vector<int> landmark_of_place_;
  geometry::PointGrid grid_;  ///< of the places
};

/// The detections of a recording with the outcomes that its map gives them, in order of time; those
/// that may be a tree or something else are left out.
///
/// They are placed in map by the poses of its trajectory, as the mapper does (deskewed where poses
/// are dense), and labelled by the landmarks they belong to: tree, object, or neither. Landmarks of
/// class unseen make their detections doubtful. `trajectory`: T_map_base over time, after all
/// corrections. Detections without a pose, or beyond observation_range_max_m, are left out.
std::vector<ProbabilitySample> landmark_samples(const std::vector<detection::Detections>& messages,
                                                const std::vector<pose::PoseEstimate>& trajectory,
                                                const LandmarkOutcomes& outcomes,
                                                const mapping::MapperConfig& config, int recording);

/// The objects of one log as landmarks in map: tree, object, or unseen for a doubtful one. Standard
/// errors are those of the mean of the object's observations. Objects without poses are left out.
std::vector<mapping::Landmark> object_landmarks(const TrunkModel& model,
                                                const std::vector<TrunkObservation>& observations,
                                                int log);

}  // namespace orchard::calibration
