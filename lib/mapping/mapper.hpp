// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "detection/detection.hpp"
#include "mapping/existence/free_space.hpp"
#include "mapping/landmark.hpp"
#include "mapping/map_update.hpp"
#include "mapping/mapper_config.hpp"
#include "mapping/split_votes.hpp"
#include "mapping/store/chunk_memory.hpp"
#include "mapping/store/state_archive.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::mapping {

/// The map: associates detections with landmarks, accumulates their evidence and statistics.
///
/// A pure function of its configuration and the sequence of update() calls. Detections are in
/// base, landmarks in map. Source: Shalal et al. 2013, section 5 and eqs. 11-13, generalised to
/// the full composition map <- base.
///
/// Of a landmark, roc_mean, n and SE are the paper's plain statistics: of the observations the
/// camera saw (all of them while it saw none: class unseen). x, y and covariance are those of the
/// mode of all its observations, composed with the poses as given and weighted by their variance.
/// probability is Bayes'. `evidence: labels`: from the labels alone, prior 1/2; each TREE or OBJECT
/// counts as the configured fractions of trees' and of objects' labels say, within 30 of log odds.
/// `evidence: probability`: from the observations' calibrated probabilities, see
/// log_odds_of_tree().
class Mapper {
 public:
  /// `p_base_laser`: where the laser sits in base; it tells what hides what. `memory` holds the
  /// observations; none: the heap.
  explicit Mapper(const MapperConfig& config, const Eigen::Vector2d& p_base_laser = {0.0, 0.0},
                  std::shared_ptr<ChunkMemory> memory = nullptr);
  ~Mapper();
  Mapper(Mapper&&) noexcept;
  Mapper& operator=(Mapper&&) noexcept;

  /// Adds the detections of one scan, observed from T_map_base at the scan's time. `free_space`:
  /// the evidence of the scan's beams; without it the scan says nothing of what is gone.
  MapUpdate update(const detection::Detections& detections, const pose::PoseEstimate& T_map_base,
                   std::shared_ptr<const FreeSpace> free_space = nullptr);

  /// Rebuilds the whole map after the past was corrected: every observation goes through update()
  /// once more, from where `corrected` puts its scan (it is given the pose as known so far). Ids
  /// are kept: a landmark has the id of that earlier one with which it shares most observations;
  /// new ids are never ones that were used before.
  MapUpdate rebuild(
      const std::function<pose::PoseEstimate(const pose::PoseEstimate& T_map_base)>& corrected);

  /// Whether something saw a place of map free, or the robot drove over it, by the poses as they
  /// are now. Asks this mapper: call it while the mapper lives and before the next update().
  std::function<bool(const Eigen::Vector2d& p_map)> seen_free() const;

  /// The same for whether scans met something at a place, too often for it to be free.
  std::function<bool(const Eigen::Vector2d& p_map)> seen_blocked() const;

  /// Ids of what never stood there, by all scans of the drive (existence/whole_drive.hpp).
  std::vector<std::int32_t> stray_ids() const;

  /// Ids of those of `landmarks`, this map's, that are legs of people (existence/leg_pairs.hpp).
  std::vector<std::int32_t> leg_ids(const std::vector<Landmark>& landmarks,
                                    bool camera_tells) const;

  /// Observations that rebuild() would go through.
  std::size_t num_observations() const;

  /// Landmark by id; throws std::out_of_range for an unknown one. Its position is cached and
  /// recomputed after every 1/16 growth in observations, so that the cost per scan is constant.
  Landmark landmark(std::int32_t id);
  std::size_t num_landmarks() const;

  /// Up to `count` ids in rising order, from `first_id` on.
  std::vector<std::int32_t> ids_from(std::int32_t first_id, std::size_t count) const;

  /// Memory of landmarks and their index; observations and free-space evidence kept for later
  /// corrections are not counted.
  std::size_t num_bytes() const;

  /// How far a tree's observations lie from its position [m]: the median of the medians of the
  /// trees with ten observations or more, of their newest 512. None without such a tree.
  std::optional<double> tree_scatter_m() const;

  /// How many landmarks' observations do not agree on a class.
  SplitVotes votes() const;

  /// All landmarks that were judged at least `min_observations` times, by camera or laser, in order
  /// of id, their positions of all that is known now.
  std::vector<Landmark> landmarks(int min_observations = 1) const;

  /// Its state; the configuration is the maker's. Observations stay in `memory`.
  void persist(StateArchive& archive);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace orchard::mapping
