// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/mapper.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "mapping/association.hpp"
#include "mapping/bulk_centre.hpp"
#include "mapping/candidate.hpp"
#include "mapping/centre_cache.hpp"
#include "mapping/id_keeping.hpp"
#include "mapping/landmark_table.hpp"
#include "mapping/observation_store.hpp"
#include "mapping/presence.hpp"

namespace orchard::mapping {
namespace {

using detection::Detection;

/// Observations, the newest, that a landmark's place is taken from: a robot that stands still for
/// an hour must not make each scan dearer than the last.
constexpr std::size_t kSamplesMost = 512;

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
  return o;
}

/// All of a detection that the map depends on.
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
  return d;
}

}  // namespace

struct Mapper::Impl {
  Impl(const MapperConfig& mapper_config, const Eigen::Vector2d& laser)
      : config(mapper_config), p_base_laser(laser), presence(mapper_config.presence, laser) {}

  MapperConfig config;
  Eigen::Vector2d p_base_laser;
  PresenceWatch presence;
  LandmarkTable landmarks;  ///< id = index + 1
  ObservationStore observations;
  CentreCache centres;

  /// Appends the index of each trunk that became an observation to `observed`, in their order.
  MapUpdate place(const detection::Detections& detections, const pose::PoseEstimate& T_map_base,
                  std::shared_ptr<const BeamLook> look,
                  std::vector<std::size_t>* observed = nullptr);
  void renumber(const std::vector<std::int32_t>& kept);
  void observe(std::int32_t index, const Candidate& candidate);
  void unite(std::int32_t keep, std::int32_t drop);
  void merge_changed(MapUpdate& update);
  void drop_gone(const std::vector<Candidate>& candidates, const pose::PoseEstimate& T_map_base,
                 const BeamLook* look, MapUpdate& update);
  BulkCentre centre_of(const LandmarkRecord& r) const;
  Landmark report(std::int32_t index, const BulkCentre& centre) const;
  std::vector<std::int32_t> landmark_of_observation() const;
};

void Mapper::Impl::observe(std::int32_t index, const Candidate& c) {
  const Detection& d = *c.detection;
  landmarks.change(index, [&](LandmarkRecord& r) {
    fuse_anchor(r, c.p_aligned, std::max(1e-6, 0.5 * c.aligned_covariance.trace()));
    fuse_width(r, d.width_m, std::max(d.width_sd_m, 0.005));
    accumulate(r, c.p_map, d.roc_tree, d.label, evidence_of(d, config), log_odds_max(config));
    r.last_observation = observations.prepend(observation_of(c), r.last_observation);
    r.last_scan = observations.last_scan();
    ++r.num_all;
  });
}

void Mapper::Impl::unite(std::int32_t keep, std::int32_t drop) {
  const LandmarkRecord dropped = landmarks[drop];
  landmarks.remove(drop);
  centres.forget(keep);
  landmarks.change(keep, [&](LandmarkRecord& kept) {
    merge(kept, dropped, log_odds_max(config));
    kept.last_observation = observations.join(dropped.last_observation, kept.last_observation);
  });
}

/// Only what a scan moved can have come upon another landmark.
void Mapper::Impl::merge_changed(MapUpdate& update) {
  std::vector<std::int32_t>& ids = update.changed_ids;
  std::sort(ids.begin(), ids.end());
  for (std::size_t k = 0; k < ids.size(); ++k) {  // grows: what a merger moved is looked at again
    const std::int32_t index = ids[k] - 1;
    if (landmarks[index].is_removed) continue;
    const std::int32_t other = merge_partner(landmarks, index, config);
    if (other < 0) continue;
    unite(std::min(index, other), std::max(index, other));
    update.removed_ids.push_back(std::max(index, other) + 1);
    ids.push_back(std::min(index, other) + 1);
  }
  const auto is_removed = [&](std::int32_t id) { return landmarks[id - 1].is_removed; };
  ids.erase(std::remove_if(ids.begin(), ids.end(), is_removed), ids.end());
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  std::sort(update.removed_ids.begin(), update.removed_ids.end());
}

void Mapper::Impl::drop_gone(const std::vector<Candidate>& candidates,
                             const pose::PoseEstimate& T_map_base, const BeamLook* look,
                             MapUpdate& update) {
  std::vector<std::int32_t> observed;
  for (const std::int32_t id : update.changed_ids) observed.push_back(id - 1);
  for (const std::int32_t i : presence.review(candidates, observed, T_map_base, look, landmarks)) {
    landmarks.remove(i);
    update.removed_ids.push_back(i + 1);
  }
}

BulkCentre Mapper::Impl::centre_of(const LandmarkRecord& r) const {
  return bulk_centre(observations.newest(r.last_observation, kSamplesMost),
                     {r.mean_x_m, r.mean_y_m}, config.centre_kernel_m);
}

Landmark Mapper::Impl::report(std::int32_t index, const BulkCentre& centre) const {
  const LandmarkRecord& r = landmarks[index];
  const Eigen::Vector2d se_m = standard_error_m(r);
  Landmark l;
  l.id = index + 1;
  l.label = label_of(r, config);
  l.num_observations = r.num_observations;
  l.x_m = centre.p_map.x();
  l.y_m = centre.p_map.y();
  l.se_x_m = se_m.x();
  l.se_y_m = se_m.y();
  l.covariance = {centre.covariance(0, 0), centre.covariance(0, 1), centre.covariance(1, 1)};
  l.width_m = r.width_m;
  l.roc_mean = r.roc_sum / r.num_observations;
  l.probability = probability_of_tree(r, config);
  return l;
}

Mapper::Mapper(const MapperConfig& config, const Eigen::Vector2d& p_base_laser)
    : impl_(std::make_unique<Impl>(config, p_base_laser)) {}
Mapper::~Mapper() = default;
Mapper::Mapper(Mapper&&) noexcept = default;
Mapper& Mapper::operator=(Mapper&&) noexcept = default;

MapUpdate Mapper::Impl::place(const detection::Detections& detections,
                              const pose::PoseEstimate& T_map_base,
                              std::shared_ptr<const BeamLook> look,
                              std::vector<std::size_t>* observed) {
  observations.add_scan(T_map_base, look);
  std::vector<Candidate> candidates =
      compose(detections, T_map_base, observations.last_composition(), config.range_use_max_m);
  pose::PoseEstimate T_map_base_aligned = T_map_base;
  if (config.align_scans) {
    T_map_base_aligned = align(candidates, T_map_base, config.align_kernel_m,
                               [&](const Eigen::Vector2d& p_map, double reach_m) {
                                 return nearest_established(landmarks, p_map, reach_m);
                               });
  }
  const Association association = associate(candidates, landmarks, config);

  MapUpdate update;
  const auto take = [&](std::int32_t index, const Candidate& c) {
    observe(index, c);
    update.changed_ids.push_back(index + 1);
    if (observed != nullptr) {
      observed->push_back(static_cast<std::size_t>(c.detection - detections.trunks.data()));
    }
  };
  for (const Pairing& pair : association.pairs) take(pair.landmark, candidates[pair.candidate]);
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (association.is_explained[k])
      continue;  // a second echo of a known landmark is none of its own
    const Candidate& c = candidates[k];
    take(landmarks.add(c.p_aligned, c.detection->width_m), c);
  }
  drop_gone(candidates, T_map_base_aligned, look.get(), update);
  merge_changed(update);
  return update;
}

/// Gives the landmark of index i the index kept[i]; indices that nobody has are removed ones.
void Mapper::Impl::renumber(const std::vector<std::int32_t>& kept) {
  LandmarkRecord removed;
  removed.is_removed = true;
  std::int32_t num_indices = 0;
  for (const std::int32_t index : kept) num_indices = std::max(num_indices, index + 1);
  std::vector<LandmarkRecord> records(static_cast<std::size_t>(num_indices), removed);
  for (std::int32_t i = 0; i < landmarks.num_indices(); ++i) {
    const std::int32_t index = kept[static_cast<std::size_t>(i)];
    if (index >= 0) records[static_cast<std::size_t>(index)] = landmarks[i];
  }
  landmarks = LandmarkTable(std::move(records));
}

/// Index of the landmark that each observation belongs to; -1 for one of none.
std::vector<std::int32_t> Mapper::Impl::landmark_of_observation() const {
  std::vector<std::int32_t> landmark_of(static_cast<std::size_t>(observations.num_observations()),
                                        -1);
  for (std::int32_t i = 0; i < landmarks.num_indices(); ++i) {
    if (landmarks[i].is_removed) continue;
    for (std::int32_t k = landmarks[i].last_observation; k >= 0; k = observations[k].previous) {
      landmark_of[static_cast<std::size_t>(k)] = i;
    }
  }
  return landmark_of;
}

MapUpdate Mapper::update(const detection::Detections& detections,
                         const pose::PoseEstimate& T_map_base,
                         std::shared_ptr<const BeamLook> look) {
  return impl_->place(detections, T_map_base, std::move(look));
}

MapUpdate Mapper::rederive(
    const std::function<pose::PoseEstimate(const pose::PoseEstimate&)>& corrected) {
  const Impl& was = *impl_;
  const std::vector<std::int32_t> landmark_then = was.landmark_of_observation();
  Impl now(was.config, was.p_base_laser);
  // Observations of a scan stand together before and after, but not in the same order.
  std::vector<std::int32_t> then_of;  // per observation of now: its landmark's index in was
  for (std::int32_t scan = 0; scan < was.observations.num_scans(); ++scan) {
    const std::int32_t first = was.observations.first_of(scan);
    detection::Detections detections;
    for (std::int32_t k = first; k < was.observations.first_of(scan + 1); ++k) {
      detections.trunks.push_back(detection_of(was.observations[k]));
    }
    std::vector<std::size_t> observed;
    now.place(detections, corrected(was.observations.pose(scan)), was.observations.look(scan),
              &observed);
    for (const std::size_t trunk : observed) {
      then_of.push_back(landmark_then[static_cast<std::size_t>(first) + trunk]);
    }
  }
  const std::vector<std::int32_t> kept =
      keep_indices(then_of, now.landmark_of_observation(), now.landmarks.num_indices(),
                   was.landmarks.num_indices());
  MapUpdate update;
  now.renumber(kept);
  for (std::int32_t i = 0; i < now.landmarks.num_indices(); ++i) {
    if (!now.landmarks[i].is_removed) {
      update.changed_ids.push_back(i + 1);
    } else if (i < was.landmarks.num_indices() && !was.landmarks[i].is_removed) {
      update.removed_ids.push_back(i + 1);
    }
  }
  *impl_ = std::move(now);
  return update;
}

std::size_t Mapper::num_observations() const {
  return static_cast<std::size_t>(impl_->observations.num_observations());
}

Landmark Mapper::landmark(std::int32_t id) {
  if (id < 1 || id > impl_->landmarks.num_indices() || impl_->landmarks[id - 1].is_removed) {
    throw std::out_of_range("no landmark with id " + std::to_string(id));
  }
  const LandmarkRecord& r = impl_->landmarks[id - 1];
  return impl_->report(id - 1,
                       impl_->centres.at(id - 1, r.num_all, [&] { return impl_->centre_of(r); }));
}

std::size_t Mapper::num_landmarks() const { return impl_->landmarks.num_alive(); }

std::size_t Mapper::num_bytes() const {
  return impl_->landmarks.num_bytes() + impl_->centres.num_bytes();
}

std::vector<std::int32_t> Mapper::ids_from(std::int32_t first_id, std::size_t count) const {
  std::vector<std::int32_t> ids;
  for (std::int32_t i = std::max(1, first_id) - 1;
       i < impl_->landmarks.num_indices() && ids.size() < count; ++i) {
    if (!impl_->landmarks[i].is_removed) ids.push_back(i + 1);
  }
  return ids;
}

std::vector<Landmark> Mapper::landmarks(int min_observations) const {
  std::vector<Landmark> all;
  for (std::int32_t i = 0; i < impl_->landmarks.num_indices(); ++i) {
    const LandmarkRecord& r = impl_->landmarks[i];
    if (r.is_removed || r.num_observations < min_observations) continue;
    all.push_back(impl_->report(i, impl_->centre_of(r)));
  }
  return all;
}

}  // namespace orchard::mapping
