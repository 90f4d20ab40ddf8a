// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/mapper.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/statistics.hpp"
#include "mapping/association.hpp"
#include "mapping/bulk_centre.hpp"
#include "mapping/candidate.hpp"
#include "mapping/centre_cache.hpp"
#include "mapping/compare/landmark_pairing.hpp"
#include "mapping/existence/existence.hpp"
#include "mapping/id_keeping.hpp"
#include "mapping/landmark_table.hpp"
#include "mapping/observation_store.hpp"
#include "mapping/stored_detection.hpp"
#include "mapping/two_things.hpp"

namespace orchard::mapping {
namespace {

using detection::Detection;

/// Observations, the newest, that a landmark's place is taken from: a robot that stands still for
/// an hour must not make each scan dearer than the last.
constexpr std::size_t kSamplesMost = 512;

/// Observations from which a tree's scatter says something.
constexpr int kScatterLeast = 10;

/// A thing that few of a landmark's observations show is none of its own.
constexpr std::size_t kSplitLeast = 8;

/// Whether a landmark of so many observations is looked at for being two things: often while it is
/// young, seldom later, so that it costs the same per observation.
bool is_review_due(std::int32_t num_observations) {
  if (num_observations < 16) return false;
  if (num_observations <= 128) return num_observations % 8 == 0;
  return (num_observations & (num_observations - 1)) == 0;
}

/// Takes one look into a record; where it lies on the map, and how surely, is what it leads by.
void take_look(LandmarkRecord& r, const Detection& d, const Eigen::Vector2d& p_map,
               const Eigen::Vector2d& p_aligned, double aligned_variance_m2,
               const MapperConfig& config) {
  fuse_anchor(r, p_aligned, std::max(1e-6, aligned_variance_m2));
  fuse_width(r, d.width_m, std::max(d.width_sd_m, 0.005));
  accumulate(r, p_map, d.roc_tree, d.label, evidence_of(d, config), log_odds_max(config));
  ++r.num_all;
}

}  // namespace

struct Mapper::Impl {
  Impl(const MapperConfig& mapper_config, const Eigen::Vector2d& laser)
      : config(mapper_config), p_base_laser(laser), presence(mapper_config.existence, laser) {}

  MapperConfig config;
  Eigen::Vector2d p_base_laser;
  PresenceWatch presence;
  LandmarkTable landmarks;  ///< id = index + 1
  ObservationStore observations;
  CentreCache centres;

  /// Appends the index of each trunk that was stored as an observation to `observed`, in their
  /// order.
  MapUpdate place(const detection::Detections& detections, const pose::PoseEstimate& T_map_base,
                  std::shared_ptr<const BeamLook> look,
                  std::vector<std::size_t>* observed = nullptr);
  void renumber(const std::vector<std::int32_t>& kept);
  void observe(std::int32_t index, const Candidate& candidate);
  void unite(std::int32_t keep, std::int32_t drop);
  void merge_changed(MapUpdate& update);
  bool are_two(std::int32_t a, std::int32_t b) const;
  void split_grown(MapUpdate& update);
  bool split(std::int32_t index, const std::vector<Piece>& pieces, const TwoPlaces& places);
  void rebuild(std::int32_t index, const LandmarkRecord& was, std::vector<std::int32_t> chain);
  void drop_gone(const std::vector<Candidate>& candidates, const pose::PoseEstimate& T_map_base,
                 const BeamLook* look, MapUpdate& update);
  BulkCentre centre_of(const LandmarkRecord& r) const;
  Landmark report(std::int32_t index, const BulkCentre& centre) const;
  std::vector<std::int32_t> landmark_of_observation() const;
};

void Mapper::Impl::observe(std::int32_t index, const Candidate& c) {
  landmarks.change(index, [&](LandmarkRecord& r) {
    take_look(r, *c.detection, c.p_map, c.p_aligned, 0.5 * c.aligned_covariance.trace(), config);
    r.last_observation = observations.prepend(observation_of(c), r.last_observation);
    r.last_scan = observations.last_scan();
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
    const std::int32_t other = merge_partner(
        landmarks, index, config, [this](std::int32_t a, std::int32_t b) { return are_two(a, b); });
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

bool Mapper::Impl::are_two(std::int32_t a, std::int32_t b) const {
  if (!config.split_landmarks) return false;
  const LandmarkRecord& fewer = landmarks[landmarks[a].num_all < landmarks[b].num_all ? a : b];
  const auto pieces =
      pieces_around(observations, fewer.last_observation, fewer.anchor(), 2.0 * config.merge_m);
  return are_two_things(pieces, landmarks[a].anchor(), landmarks[b].anchor());
}

/// Gates that are wide enough for poses that are off take two things for one where they stand
/// nearer than that. What scans show at once tells, once there are some of them.
void Mapper::Impl::split_grown(MapUpdate& update) {
  if (!config.split_landmarks || 2.0 * config.gate_m <= config.split_distance_m) return;
  const std::size_t num_changed = update.changed_ids.size();
  for (std::size_t k = 0; k < num_changed; ++k) {
    const std::int32_t index = update.changed_ids[k] - 1;
    const LandmarkRecord& r = landmarks[index];
    if (r.is_removed || !is_review_due(r.num_all)) continue;
    const auto pieces = pieces_around(observations, r.last_observation, r.anchor(), config.gate_m);
    const auto places = two_places(pieces, config.split_distance_m);
    if (!places) continue;
    bool is_known = false;
    for (const Eigen::Vector2d& place : {places->first, places->second}) {
      landmarks.near(
          place, 0.5 * config.split_distance_m, [&](std::int32_t i, const LandmarkRecord& other) {
            const double distance_m = (other.anchor() - place).norm();
            is_known = is_known || (i != index && distance_m < 0.5 * config.split_distance_m);
          });
    }
    if (is_known || !split(index, pieces, *places)) continue;
    update.changed_ids.push_back(landmarks.num_indices());
  }
}

/// Each observation of the landmark goes to the nearer place. A scan that gave it to one of them
/// and kept an echo at the other has now seen both. False, and nothing done, where that leaves one
/// of them with few.
bool Mapper::Impl::split(std::int32_t index, const std::vector<Piece>& pieces,
                         const TwoPlaces& places) {
  const auto is_nearer_second = [&](const Eigen::Vector2d& p) {
    return (p - places.second).squaredNorm() < (p - places.first).squaredNorm();
  };
  constexpr auto kAll = std::numeric_limits<std::size_t>::max();
  std::array<std::vector<std::int32_t>, 2> chains;
  std::array<std::set<std::int32_t>, 2> scans;
  for (const std::int32_t k : observations.newest_of(landmarks[index].last_observation, kAll)) {
    const int to = is_nearer_second(observations.p_map(k)) ? 1 : 0;
    chains[to].push_back(k);
    scans[to].insert(observations[k].scan);
  }
  for (const Piece& piece : pieces) {
    const int to = is_nearer_second(piece.p_map) ? 1 : 0;
    const double away_m = (piece.p_map - (to == 1 ? places.second : places.first)).norm();
    if (observations[piece.observation].is_owned || away_m > 0.5 * config.split_distance_m)
      continue;
    if (scans[to].insert(piece.scan).second) chains[to].push_back(piece.observation);
  }
  if (std::min(chains[0].size(), chains[1].size()) < kSplitLeast) return false;
  const LandmarkRecord was = landmarks[index];
  rebuild(index, was, std::move(chains[0]));
  rebuild(landmarks.add(places.second, was.width_m), was, std::move(chains[1]));
  return true;
}

/// Makes a landmark what these observations alone would have made of it, but for its presence.
void Mapper::Impl::rebuild(std::int32_t index, const LandmarkRecord& was,
                           std::vector<std::int32_t> chain) {
  std::sort(chain.begin(), chain.end());
  LandmarkRecord r;
  r.presence = was.presence;
  r.sides_seen = was.sides_seen;
  r.anchor_x_m = observations.p_map(chain.front()).x();
  r.anchor_y_m = observations.p_map(chain.front()).y();
  for (const std::int32_t k : chain) {
    const Observation& o = observations[k];
    const Eigen::Vector2d p = observations.p_map(k);
    take_look(r, detection_of(o), p, p, static_cast<double>(o.sd_m) * o.sd_m, config);
    r.last_scan = o.scan;
  }
  r.last_observation = observations.relink(std::move(chain));
  centres.forget(index);
  landmarks.change(index, [&](LandmarkRecord& record) { record = r; });
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
  std::vector<Candidate> candidates = compose(
      detections, T_map_base, observations.last_composition(), config.observation_range_max_m);
  pose::PoseEstimate T_map_base_aligned = T_map_base;
  if (config.align_scans) {
    T_map_base_aligned = align(candidates, T_map_base, config.align_kernel_m,
                               [&](const Eigen::Vector2d& p_map, double reach_m) {
                                 return nearest_established(landmarks, p_map, reach_m);
                               });
  }
  const Association association = associate(candidates, landmarks, config);

  MapUpdate update;
  const auto note = [&](const Candidate& c) {
    if (observed == nullptr) return;
    observed->push_back(static_cast<std::size_t>(c.detection - detections.trunks.data()));
  };
  const auto take = [&](std::int32_t index, const Candidate& c) {
    observe(index, c);
    update.changed_ids.push_back(index + 1);
    note(c);
  };
  for (const Pairing& pair : association.pairs) take(pair.landmark, candidates[pair.candidate]);
  std::vector<char> is_paired(candidates.size(), 0);
  for (const Pairing& pair : association.pairs) is_paired[pair.candidate] = 1;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const Candidate& c = candidates[k];
    if (is_paired[k]) continue;
    if (association.is_explained[k]) {
      // a second echo of a known landmark is none of its own, as far as poses are known now
      observations.add_unowned(observation_of(c));
      note(c);
    } else {
      take(landmarks.add(c.p_aligned, c.detection->width_m), c);
    }
  }
  drop_gone(candidates, T_map_base_aligned, look.get(), update);
  split_grown(update);
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

std::optional<double> Mapper::tree_scatter_m() const {
  std::vector<double> medians_m;
  for (std::int32_t i = 0; i < impl_->landmarks.num_indices(); ++i) {
    const LandmarkRecord& r = impl_->landmarks[i];
    if (r.is_removed || r.num_all < kScatterLeast ||
        label_of(r, impl_->config) != detection::Label::kTree) {
      continue;
    }
    const Eigen::Vector2d centre = impl_->centre_of(r).p_map;
    std::vector<double> distances_m;
    for (const std::int32_t k : impl_->observations.newest_of(r.last_observation, kSamplesMost)) {
      distances_m.push_back((impl_->observations.p_map(k) - centre).norm());
    }
    medians_m.push_back(geometry::median(std::move(distances_m)));
  }
  if (medians_m.empty()) return std::nullopt;
  return geometry::median(std::move(medians_m));
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
