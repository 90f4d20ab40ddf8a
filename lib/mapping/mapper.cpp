// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/mapper.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "mapping/association.hpp"
#include "mapping/bulk_centre.hpp"
#include "mapping/candidate.hpp"
#include "mapping/landmark_table.hpp"
#include "mapping/observation_store.hpp"

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
  o.label = static_cast<std::int8_t>(d.label);
  return o;
}

}  // namespace

struct Mapper::Impl {
  explicit Impl(const MapperConfig& mapper_config) : config(mapper_config) {}

  MapperConfig config;
  LandmarkTable landmarks;  ///< id = index + 1
  ObservationStore observations;

  void observe(std::int32_t index, const Candidate& candidate);
  void unite(std::int32_t keep, std::int32_t drop);
  void merge_changed(MapUpdate& update);
  Landmark report(std::int32_t index) const;
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

Landmark Mapper::Impl::report(std::int32_t index) const {
  const LandmarkRecord& r = landmarks[index];
  const Eigen::Vector2d se_m = standard_error_m(r);
  const BulkCentre centre = bulk_centre(observations.newest(r.last_observation, kSamplesMost),
                                        {r.mean_x_m, r.mean_y_m}, config.centre_kernel_m);
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

Mapper::Mapper(const MapperConfig& config) : impl_(std::make_unique<Impl>(config)) {}
Mapper::~Mapper() = default;
Mapper::Mapper(Mapper&&) noexcept = default;
Mapper& Mapper::operator=(Mapper&&) noexcept = default;

MapUpdate Mapper::update(const detection::Detections& detections,
                         const pose::PoseEstimate& T_map_base) {
  Impl& m = *impl_;
  m.observations.add_scan(T_map_base);
  std::vector<Candidate> candidates =
      compose(detections, T_map_base, m.observations.last_composition(), m.config.range_use_max_m);
  if (m.config.align_scans) {
    align(candidates, T_map_base, m.config.align_kernel_m,
          [&](const Eigen::Vector2d& p_map, double reach_m) {
            return nearest_established(m.landmarks, p_map, reach_m);
          });
  }
  const Association association = associate(candidates, m.landmarks, m.config);

  MapUpdate update;
  for (const Pairing& pair : association.pairs) {
    m.observe(pair.landmark, candidates[pair.candidate]);
    update.changed_ids.push_back(pair.landmark + 1);
  }
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (association.is_explained[k])
      continue;  // a second echo of a known landmark is none of its own
    const Candidate& c = candidates[k];
    const std::int32_t index = m.landmarks.add(c.p_aligned, c.detection->width_m);
    m.observe(index, c);
    update.changed_ids.push_back(index + 1);
  }
  m.merge_changed(update);
  return update;
}

Landmark Mapper::landmark(std::int32_t id) const {
  if (id < 1 || id > impl_->landmarks.num_indices() || impl_->landmarks[id - 1].is_removed) {
    throw std::out_of_range("no landmark with id " + std::to_string(id));
  }
  return impl_->report(id - 1);
}

std::size_t Mapper::num_landmarks() const { return impl_->landmarks.num_alive(); }

std::size_t Mapper::num_bytes() const { return impl_->landmarks.num_bytes(); }

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
    all.push_back(impl_->report(i));
  }
  return all;
}

}  // namespace orchard::mapping
