// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/store/observation_store.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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

void ObservationStore::add_scan(const pose::PoseEstimate& T_map_base, const FreeSpace* free_space) {
  Scan scan{T_map_base, PoseComposition(T_map_base), num_observations(), -1};
  if (free_space != nullptr) {
    scan.free_space = static_cast<std::int64_t>(beams_.size());
    const std::vector<std::uint8_t> bytes = free_space->pack();
    const auto size = static_cast<std::uint32_t>(bytes.size());
    for (int i = 0; i < 4; ++i) beams_.push_back(static_cast<std::uint8_t>(size >> (8 * i)));
    for (const std::uint8_t byte : bytes) beams_.push_back(byte);
  }
  scans_.push_back(scan);
}

std::shared_ptr<const FreeSpace> ObservationStore::free_space(std::int32_t scan) const {
  if (at(scan).free_space < 0) return nullptr;
  auto next = static_cast<std::size_t>(at(scan).free_space);
  std::uint32_t size = 0;
  for (int i = 0; i < 4; ++i) size |= std::uint32_t{beams_[next++]} << (8 * i);
  std::vector<std::uint8_t> bytes(size);
  for (std::size_t done = 0; done < bytes.size();) {
    const auto [run, size_of_run] = beams_.run_from(next + done);
    const std::size_t num = std::min(size_of_run, bytes.size() - done);
    std::copy(run, run + num, bytes.begin() + static_cast<std::ptrdiff_t>(done));
    done += num;
  }
  return std::make_shared<FreeSpace>(FreeSpace::unpack(bytes));
}

std::int32_t ObservationStore::prepend(Observation observation, std::int32_t head) {
  observation.scan = last_scan();
  observation.previous = head;
  observations_.push_back(observation);
  return static_cast<std::int32_t>(observations_.size()) - 1;
}

void ObservationStore::add_unassociated(Observation observation) { prepend(observation, -1); }

std::int32_t ObservationStore::join(std::int32_t newer, std::int32_t older) {
  std::int32_t tail = newer;
  while (observations_[static_cast<std::size_t>(tail)].previous >= 0) {
    tail = observations_[static_cast<std::size_t>(tail)].previous;
  }
  observations_.edit(static_cast<std::size_t>(tail)).previous = older;
  return newer;
}

std::vector<std::int32_t> ObservationStore::newest_of(std::int32_t head, std::size_t most) const {
  std::vector<std::int32_t> chain;
  for (std::int32_t k = head; k >= 0 && chain.size() < most; k = (*this)[k].previous) {
    chain.push_back(k);
  }
  return chain;
}

Eigen::Vector2d ObservationStore::p_map(std::int32_t observation) const {
  const Observation& o = (*this)[observation];
  return at(o.scan).composition.apply(o.x_base_m, o.y_base_m);
}

std::vector<WeightedPoint> ObservationStore::newest(std::int32_t head, std::size_t most) const {
  std::vector<WeightedPoint> points;
  points.reserve(std::min<std::size_t>(most, 64));
  for (std::int32_t k = head; k >= 0 && points.size() < most;) {
    const Observation& o = observations_[static_cast<std::size_t>(k)];
    const double variance_m2 = std::max(1e-6, static_cast<double>(o.sd_m) * o.sd_m);
    points.push_back({at(o.scan).composition.apply(o.x_base_m, o.y_base_m), 1.0 / variance_m2});
    k = o.previous;
  }
  return points;
}

}  // namespace orchard::mapping
