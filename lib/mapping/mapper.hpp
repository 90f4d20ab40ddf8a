// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "detection/detection.hpp"
#include "mapping/existence/ground_occupancy.hpp"
#include "mapping/free_space.hpp"
#include "mapping/landmark.hpp"
#include "mapping/map_state.hpp"
#include "mapping/mapper_config.hpp"
#include "mapping/store/chunked_array.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::mapping {

/// Builds the landmark map: associates detections with landmarks and accumulates their evidence and
/// statistics.
///
/// Deterministic: depends only on the configuration and the sequence of update() calls. Detections
/// are in base, landmarks in map. Source: Shalal et al. 2013, section 5 and eqs. 11-13, generalised
/// to the full composition map <- base.
///
/// roc_mean, num_observations and the standard errors of a landmark are the paper's plain
/// statistics over the labelled observations (TREE or OBJECT; over all while there is none: class
/// unseen). x, y and covariance are those of the mode of all observations, composed with the given
/// poses and weighted by inverse variance. probability is the Bayesian posterior, see
/// probability_of_tree(). `evidence: labels`: from labels only, prior 1/2, with the label rates of
/// trees and objects, log odds within +-30. `evidence: probability`: from the calibrated
/// probabilities of the observations.
class Mapper {
 public:
  /// `p_base_laser`: laser position in base, used by the existence filter. `memory` stores the
  /// observations; the heap if null.
  explicit Mapper(const MapperConfig& config, const Eigen::Vector2d& p_base_laser = {0.0, 0.0},
                  std::shared_ptr<ChunkAllocator> memory = nullptr);
  ~Mapper();
  Mapper(Mapper&&) noexcept;
  Mapper& operator=(Mapper&&) noexcept;

  /// Adds the detections of one scan, observed from T_map_base at the scan's time. `free_space`:
  /// free-space evidence of its beams; without it no landmark is dropped by this scan.
  MapUpdate update(const detection::Detections& detections, const pose::PoseEstimate& T_map_base,
                   std::shared_ptr<const FreeSpace> free_space = nullptr);

  /// Rebuilds the whole map after a correction of past poses. Every observation passes through
  /// update() again with the pose corrected(T_map_base) of its scan, where T_map_base is the pose
  /// known so far. Ids are kept: a landmark gets the id of the earlier landmark with which it
  /// shares most observations; new ids were never used before.
  MapUpdate rebuild(
      const std::function<pose::PoseEstimate(const pose::PoseEstimate& T_map_base)>& corrected);

  const MapperConfig& config() const;

  /// Free and blocked ground by the scans, with the current poses. It refers to this mapper: use it
  /// only during the mapper's lifetime and before the next update().
  std::shared_ptr<GroundOccupancy> ground() const;

  /// Ids of landmarks that never existed, judged by all scans (spurious_landmarks()).
  /// `ground`: that of this mapper.
  std::vector<std::int32_t> spurious_ids(GroundOccupancy& ground) const;

  /// Number of observations that rebuild() would process.
  std::size_t num_observations() const;

  /// Landmark by id; throws std::out_of_range for an unknown one. Its position is cached and
  /// recomputed after every 1/16 growth in observations, so that the cost per scan is constant.
  Landmark landmark(std::int32_t id);
  std::size_t num_landmarks() const;

  /// Up to `count` ids in ascending order, starting at `first_id`.
  std::vector<std::int32_t> ids_from(std::int32_t first_id, std::size_t count) const;

  /// Memory of the landmarks and their index [bytes], without the observations and free-space
  /// evidence stored for corrections.
  std::size_t num_bytes() const;

  /// Typical distance of a tree's observations from its position [m]: median over trees with at
  /// least ten observations of the median over their newest 512. None without such a tree.
  std::optional<double> tree_scatter_m() const;

  /// Number of landmarks whose observations disagree on the class.
  LabelConflicts label_conflicts() const;

  /// `start` at the densest place near it of the newest observations of all `parts` (ids, known
  /// ones), with the covariance of that place and standard errors by the scatter of them all: map
  /// frame [m, m2].
  Landmark common_place(const Landmark& start, const std::vector<std::int32_t>& parts) const;

  /// All landmarks with at least `min_observations` observations judged by camera or laser, in
  /// order of id, with positions from all current observations.
  std::vector<Landmark> landmarks(int min_observations = 1) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace orchard::mapping
