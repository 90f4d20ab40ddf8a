// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/mapper.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/statistics.hpp"
#include "mapping/association.hpp"
#include "mapping/candidate.hpp"
#include "mapping/existence/existence.hpp"
#include "mapping/existence/ground_occupancy.hpp"
#include "mapping/extent/extent.hpp"
#include "mapping/map_state.hpp"
#include "mapping/store/observation_store.hpp"

namespace orchard::mapping {
namespace {

/// derived: Minimum number of observations for a tree's scatter.
constexpr int kScatterObservationsMin = 10;

/// Merges each changed landmark with its merge partner, repeatedly, until none has one.
void merge_changed(MapState& map, MapUpdate& update) {
  std::vector<std::int32_t>& ids = update.changed_ids;
  const LandmarkTable& landmarks = map.landmarks;
  std::sort(ids.begin(), ids.end());
  for (std::size_t k = 0; k < ids.size(); ++k) {  // appends, to examine merged landmarks again
    const std::int32_t index = ids[k] - 1;
    if (landmarks[index].is_removed) continue;
    std::int32_t other = merge_partner(landmarks, index, map.config);
    const bool is_clump = other < 0;
    if (is_clump) other = touching_clump(landmarks, index, map.config);
    if (other < 0) continue;
    map.merge(std::min(index, other), std::max(index, other));
    if (is_clump) {
      map.landmarks.change(std::min(index, other), [](LandmarkRecord& r) { r.is_clump = true; });
    }
    update.removed_ids.push_back(std::max(index, other) + 1);
    ids.push_back(std::min(index, other) + 1);
  }
  const auto is_removed = [&](std::int32_t id) { return landmarks[id - 1].is_removed; };
  ids.erase(std::remove_if(ids.begin(), ids.end(), is_removed), ids.end());
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  std::sort(update.removed_ids.begin(), update.removed_ids.end());
}

/// Whether a landmark has enough observations judged by the camera, or by the laser where no image
/// shows it. A tree beside the robot is outside the image in most observations.
bool is_seen_often(const MapState& map, const LandmarkRecord& r, int min_observations) {
  if (r.num_observations >= min_observations) return true;
  if (r.num_all < min_observations) return false;
  int num_judged = 0;
  for (std::int32_t k = r.last_observation; k >= 0 && num_judged < min_observations;) {
    const Observation& o = map.observations[k];
    num_judged += o.label != static_cast<std::int8_t>(detection::Label::kUnseen) ||
                  o.probability_tree + o.probability_object > 0.0f;
    k = o.previous;
  }
  return num_judged >= min_observations;
}

}  // namespace

struct Mapper::Impl {
  Impl(const MapperConfig& config, const Eigen::Vector2d& laser,
       const std::shared_ptr<ChunkAllocator>& chunks)
      : p_base_laser(laser),
        memory(chunks),
        existence(config.existence, laser),
        map(config, chunks) {}

  /// Adds one scan. Appends to `stored` the index of each trunk stored as an observation, in order
  /// of storage.
  MapUpdate update(const detection::Detections& detections, const pose::PoseEstimate& T_map_base,
                   std::shared_ptr<const FreeSpace> free_space,
                   std::vector<std::size_t>* stored = nullptr);

  Eigen::Vector2d p_base_laser;
  std::shared_ptr<ChunkAllocator> memory;
  ExistenceFilter existence;
  MapState map;
};

Mapper::Mapper(const MapperConfig& config, const Eigen::Vector2d& p_base_laser,
               std::shared_ptr<ChunkAllocator> memory)
    : impl_(std::make_unique<Impl>(
          config, p_base_laser,
          memory ? std::move(memory) : std::make_shared<HeapChunkAllocator>())) {}
Mapper::~Mapper() = default;
Mapper::Mapper(Mapper&&) noexcept = default;
Mapper& Mapper::operator=(Mapper&&) noexcept = default;

MapUpdate Mapper::Impl::update(const detection::Detections& detections,
                               const pose::PoseEstimate& T_map_base,
                               std::shared_ptr<const FreeSpace> free_space,
                               std::vector<std::size_t>* stored) {
  const MapperConfig& config = map.config;
  map.observations.add_scan(T_map_base, free_space.get());
  std::vector<Candidate> candidates = compose(
      detections, T_map_base, map.observations.last_composition(), config.observation_range_max_m);
  for (Candidate& c : candidates) {
    if (!free_space) break;
    c.clearance = free_space->clearance({c.detection->centre_x_m, c.detection->centre_y_m});
  }
  pose::PoseEstimate T_map_base_aligned = T_map_base;
  if (config.align_scans) {
    T_map_base_aligned = align(candidates, T_map_base, config.align_kernel_m,
                               [&](const Eigen::Vector2d& p_map, double reach_m) {
                                 return nearest_established(map.landmarks, p_map, reach_m);
                               });
  }
  const Association association = associate(candidates, map.landmarks, config);

  MapUpdate update;
  const auto note_stored = [&](const Candidate& c) {
    if (stored == nullptr) return;
    stored->push_back(static_cast<std::size_t>(c.detection - detections.trunks.data()));
  };
  const auto add = [&](std::int32_t index, const Candidate& c) {
    map.add_observation(index, c);
    update.changed_ids.push_back(index + 1);
    note_stored(c);
  };
  std::vector<char> is_paired(candidates.size(), 0);
  for (const Pairing& pair : association.pairs) {
    add(pair.landmark, candidates[pair.candidate]);
    is_paired[pair.candidate] = 1;
  }
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const Candidate& c = candidates[k];
    if (is_paired[k]) continue;
    const double sd_m = std::sqrt(0.5 * c.aligned_covariance.trace());
    if (association.is_explained[k] ||
        existence.was_free_before(c.p_aligned, c.detection->width_m, sd_m)) {
      // A secondary return of a known landmark, or, with the current poses, a moving object.
      map.observations.add_unassociated(observation_of(c));
      note_stored(c);
    } else {
      add(map.landmarks.add(c.p_aligned, c.detection->width_m), c);
    }
  }

  if (free_space) existence.update(free_space, T_map_base_aligned, map.landmarks, update);
  merge_changed(map, update);
  return update;
}

MapUpdate Mapper::update(const detection::Detections& detections,
                         const pose::PoseEstimate& T_map_base,
                         std::shared_ptr<const FreeSpace> free_space) {
  return impl_->update(detections, T_map_base, std::move(free_space));
}

MapUpdate Mapper::rebuild(
    const std::function<pose::PoseEstimate(const pose::PoseEstimate&)>& corrected) {
  const MapState& was = impl_->map;
  const ChunkedArray<std::int32_t> landmark_then = was.landmark_of_observation();
  Impl now(was.config, impl_->p_base_laser, impl_->memory);
  // The observations of a scan are contiguous before and after, but in a different order.
  ChunkedArray<std::int32_t> then_of(
      impl_->memory);  // per new observation: index of its landmark in `was`
  for (std::int32_t scan = 0; scan < was.observations.num_scans(); ++scan) {
    const std::int32_t first = was.observations.first_of(scan);
    detection::Detections detections;
    for (std::int32_t k = first; k < was.observations.first_of(scan + 1); ++k) {
      detections.trunks.push_back(detection_of(was.observations[k]));
    }
    std::vector<std::size_t> stored;
    now.update(detections, corrected(was.observations.pose(scan)),
               was.observations.free_space(scan), &stored);
    for (const std::size_t trunk : stored) {
      then_of.push_back(landmark_then[static_cast<std::size_t>(first) + trunk]);
    }
  }
  const auto thens_of = [&](std::int32_t i) {
    std::vector<std::int32_t> all = now.map.observations_of(i);
    for (std::int32_t& k : all) k = then_of[static_cast<std::size_t>(k)];
    return all;
  };
  now.map.renumber(
      keep_indices(thens_of, now.map.landmarks.num_indices(), was.landmarks.num_indices()));
  MapUpdate update;
  for (std::int32_t i = 0; i < now.map.landmarks.num_indices(); ++i) {
    if (!now.map.landmarks[i].is_removed) {
      update.changed_ids.push_back(i + 1);
    } else if (i < was.landmarks.num_indices() && !was.landmarks[i].is_removed) {
      update.removed_ids.push_back(i + 1);
    }
  }
  *impl_ = std::move(now);
  return update;
}

const MapperConfig& Mapper::config() const { return impl_->map.config; }

std::shared_ptr<GroundOccupancy> Mapper::ground() const {
  const ObservationStore& scans = impl_->map.observations;
  auto ground = std::make_shared<GroundOccupancy>(
      [&scans](std::int32_t scan) { return scans.free_space(scan); });
  for (std::int32_t scan = 0; scan < scans.num_scans(); ++scan) {
    ground->add_scan(scan, scans.pose(scan), scans.has_free_space(scan));
  }
  return ground;
}

std::vector<std::int32_t> Mapper::spurious_ids(GroundOccupancy& ground) const {
  const MapState& map = impl_->map;
  std::vector<std::int32_t> ids = spurious_landmarks(map, ground);
  for (std::int32_t& id : ids) ++id;
  return ids;
}

std::size_t Mapper::num_observations() const {
  return static_cast<std::size_t>(impl_->map.observations.num_observations());
}

Landmark Mapper::landmark(std::int32_t id) {
  if (id < 1 || id > impl_->map.landmarks.num_indices() ||
      impl_->map.landmarks[id - 1].is_removed) {
    throw std::out_of_range("no landmark with id " + std::to_string(id));
  }
  const LandmarkRecord& r = impl_->map.landmarks[id - 1];
  return impl_->map.report(
      id - 1, impl_->map.modes.at(id - 1, r.num_all, [&] { return impl_->map.mode_of(r); }));
}

std::size_t Mapper::num_landmarks() const { return impl_->map.landmarks.num_alive(); }

std::size_t Mapper::num_bytes() const {
  return impl_->map.landmarks.num_bytes() + impl_->map.modes.num_bytes();
}

std::vector<std::int32_t> Mapper::ids_from(std::int32_t first_id, std::size_t count) const {
  std::vector<std::int32_t> ids;
  for (std::int32_t i = std::max(1, first_id) - 1;
       i < impl_->map.landmarks.num_indices() && ids.size() < count; ++i) {
    if (!impl_->map.landmarks[i].is_removed) ids.push_back(i + 1);
  }
  return ids;
}

std::optional<double> Mapper::tree_scatter_m() const {
  std::vector<double> medians_m;
  for (std::int32_t i = 0; i < impl_->map.landmarks.num_indices(); ++i) {
    const LandmarkRecord& r = impl_->map.landmarks[i];
    if (r.is_removed || r.num_all < kScatterObservationsMin ||
        label_of(r, impl_->map.config) != detection::Label::kTree) {
      continue;
    }
    const Eigen::Vector2d mode = impl_->map.mode_of(r).p_map;
    std::vector<double> distances_m;
    for (const std::int32_t k :
         impl_->map.observations.newest_of(r.last_observation, kPositionSamplesMax)) {
      distances_m.push_back((impl_->map.observations.p_map(k) - mode).norm());
    }
    medians_m.push_back(geometry::median(std::move(distances_m)));
  }
  if (medians_m.empty()) return std::nullopt;
  return geometry::median(std::move(medians_m));
}

LabelConflicts Mapper::label_conflicts() const { return count_label_conflicts(impl_->map); }

Landmark Mapper::common_place(const Landmark& start, const std::vector<std::int32_t>& parts) const {
  const MapState& map = impl_->map;
  std::vector<WeightedPoint> points;
  for (const std::int32_t id : parts) {
    const std::int32_t newest = map.landmarks[id - 1].last_observation;
    for (const WeightedPoint& point : map.observations.newest(newest, kPositionSamplesMax)) {
      points.push_back(point);
    }
  }
  const PositionMode mode =
      position_mode(points, {start.x_m, start.y_m}, map.config.centre_kernel_m);
  // Its observations scatter as far as those of all parts: another drive may see another one most.
  const Eigen::Matrix2d scatter_m2 = scatter_around(mode.p_map, points);
  Landmark l = start;
  l.x_m = mode.p_map.x();
  l.y_m = mode.p_map.y();
  l.se_x_m = std::sqrt(scatter_m2(0, 0) / std::max(1, l.num_observations));
  l.se_y_m = std::sqrt(scatter_m2(1, 1) / std::max(1, l.num_observations));
  l.covariance = {mode.covariance(0, 0), mode.covariance(0, 1), mode.covariance(1, 1)};
  return l;
}

std::vector<Landmark> Mapper::landmarks(int min_observations) const {
  std::vector<Landmark> all;
  for (std::int32_t i = 0; i < impl_->map.landmarks.num_indices(); ++i) {
    const LandmarkRecord& r = impl_->map.landmarks[i];
    if (r.is_removed || !is_seen_often(impl_->map, r, min_observations)) continue;
    all.push_back(impl_->map.report(i, impl_->map.mode_of(r)));
  }
  return all;
}

}  // namespace orchard::mapping
