// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/mapper.hpp"

#include <mrpt/poses/CPose3D.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "mapping/landmark_grid.hpp"
#include "mapping/observation.hpp"
#include "mapping/scan_alignment.hpp"

namespace orchard::mapping {
namespace {

using detection::Detection;
using detection::Label;

constexpr double kLogOddsMax = 30.0;
constexpr int kEstablished = 3;      ///< observations from which a landmark guides an alignment
constexpr int kCentreRounds = 12;
/// Observations, the newest, that a landmark's place is taken from: a robot that stands still for an
/// hour must not make each scan dearer than the last.
constexpr std::size_t kSamplesMost = 512;
constexpr double kWidthRelativeSd = 0.15;  ///< of one thing seen from different sides

/// What is kept per landmark. 104 bytes; its observations are chained in Mapper::Impl.
struct Record {
  double anchor_x_m = 0.0;   ///< mean of the aligned observations: what association compares with
  double anchor_y_m = 0.0;
  double mean_x_m = 0.0;     ///< plain mean of the composed observations (Welford)
  double mean_y_m = 0.0;
  double roc_sum = 0.0;
  float m2_xx = 0.0f;        ///< sums of squares about the mean
  float m2_xy = 0.0f;
  float m2_yy = 0.0f;
  float anchor_information = 0.0f;  ///< 1 / m2
  float scatter_m2 = 0.0f;          ///< of the aligned observations about the anchor, per axis
  float width_m = 0.0f;
  float width_information = 0.0f;
  float log_odds = 0.0f;
  std::int32_t num_observations = 0;  ///< N of eq. 13
  std::int32_t num_all = 0;           ///< UNSEEN ones too
  std::int32_t last_observation = -1;
  std::int32_t last_scan = -1;
  bool is_seen = false;               ///< by the camera, or laser-only rig
  bool is_removed = false;
};

/// One scan that was used, kept for a later correction of its pose.
struct UsedScan {
  std::int64_t utime = 0;
  pose::PoseEstimate T_map_base;
};

/// A detection in map.
struct Candidate {
  const Detection* detection = nullptr;
  Eigen::Vector2d p_map;          ///< by the pose
  Eigen::Vector2d p_aligned;      ///< and moved with its scan onto the map
  Eigen::Matrix2d covariance;     ///< of p_map: detection and pose
  Eigen::Matrix2d aligned_covariance;
  double range_m = 0.0;           ///< from base
};

struct Pairing {
  double cost = 0.0;
  std::int32_t landmark = 0;
  std::size_t candidate = 0;
};

Eigen::Matrix3d matrix_of(const std::array<double, 6>& c) {
  Eigen::Matrix3d m;
  m << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  return m;
}

/// Covariance in map of a point at `arm` from the robot whose pose has `pose_covariance`.
Eigen::Matrix2d swept(const Eigen::Matrix3d& pose_covariance, const Eigen::Vector2d& arm) {
  Eigen::Matrix<double, 2, 3> jacobian;
  jacobian << 1, 0, -arm.y(), 0, 1, arm.x();
  return jacobian * pose_covariance * jacobian.transpose();
}

}  // namespace

struct Mapper::Impl {
  explicit Impl(const MapperConfig& mapper_config) : config(mapper_config) {}

  MapperConfig config;
  std::vector<Record> records;           ///< id = index + 1
  std::vector<Observation> observations;
  std::vector<UsedScan> scans;
  LandmarkGrid grid;
  std::size_t num_alive = 0;

  std::vector<Candidate> candidates_of(const detection::Detections& detections,
                                       const pose::PoseEstimate& pose) const;
  void align(std::vector<Candidate>& candidates, const pose::PoseEstimate& pose) const;
  void pair_with_landmarks(const std::vector<Candidate>& candidates, std::vector<Pairing>& pairs,
                           std::vector<char>& explained) const;
  std::int32_t create(const Candidate& candidate);
  void observe(std::int32_t index, const Candidate& candidate);
  void accumulate(Record& r, const Eigen::Vector2d& p_map, double roc_tree, Label label) const;
  std::int32_t merge_partner(std::int32_t index) const;
  void merge(std::int32_t keep, std::int32_t drop);
  Landmark report(std::int32_t index) const;
};

std::vector<Candidate> Mapper::Impl::candidates_of(const detection::Detections& detections,
                                                   const pose::PoseEstimate& pose) const {
  const mrpt::poses::CPose3D T_map_base(pose.x_m, pose.y_m, 0.0, pose.yaw_rad, pose.pitch_rad,
                                        pose.roll_rad);
  const Eigen::Vector2d robot(pose.x_m, pose.y_m);
  const Eigen::Matrix3d pose_covariance = matrix_of(pose.covariance);
  const double c = std::cos(pose.yaw_rad);
  const double s = std::sin(pose.yaw_rad);
  Eigen::Matrix2d rotation;
  rotation << c, -s, s, c;
  std::vector<Candidate> candidates;
  candidates.reserve(detections.trunks.size());
  for (const Detection& d : detections.trunks) {
    Candidate candidate;
    candidate.detection = &d;
    candidate.range_m = std::hypot(d.centre_x_m, d.centre_y_m);
    if (candidate.range_m > config.range_use_max_m) continue;
    double x = 0.0;
    double y = 0.0;
    double z = 0.0;
    T_map_base.composePoint(d.centre_x_m, d.centre_y_m, 0.0, x, y, z);
    candidate.p_map = {x, y};
    if (!candidate.p_map.allFinite() || candidate.p_map.cwiseAbs().maxCoeff() > 1e9) continue;
    candidate.p_aligned = candidate.p_map;
    Eigen::Matrix2d own;
    own << d.covariance[0], d.covariance[1], d.covariance[1], d.covariance[2];
    own = rotation * own * rotation.transpose();
    own.diagonal().array() += 1e-6;  // 1 mm: nothing is known better
    candidate.covariance = own + swept(pose_covariance, candidate.p_map - robot);
    candidate.aligned_covariance = candidate.covariance;
    candidates.push_back(candidate);
  }
  return candidates;
}

void Mapper::Impl::align(std::vector<Candidate>& candidates,
                         const pose::PoseEstimate& pose) const {
  const Eigen::Vector2d robot(pose.x_m, pose.y_m);
  const Eigen::Matrix3d pose_covariance = matrix_of(pose.covariance);
  std::vector<AlignmentPoint> points;
  for (const Candidate& c : candidates) {
    if (c.detection->label == Label::kObject) continue;  // bushes look different from each side
    const Eigen::Matrix2d own = c.covariance - swept(pose_covariance, c.p_map - robot);
    points.push_back({c.p_map, std::sqrt(std::max(1e-8, 0.5 * own.trace()))});
  }
  const auto nearest = [&](const Eigen::Vector2d& p,
                           double reach_m) -> std::optional<Eigen::Vector2d> {
    double best_m2 = reach_m * reach_m;
    std::optional<Eigen::Vector2d> best;
    grid.near(p.x(), p.y(), reach_m, [&](std::int32_t i) {
      const Record& r = records[static_cast<std::size_t>(i)];
      if (r.num_all < kEstablished || r.log_odds < 0.0f) return;
      const Eigen::Vector2d l(r.anchor_x_m, r.anchor_y_m);
      const double distance_m2 = (l - p).squaredNorm();
      if (distance_m2 < best_m2) {
        best_m2 = distance_m2;
        best = l;
      }
    });
    return best;
  };
  const ScanAlignment alignment =
      align_scan(points, robot, pose_covariance, config.align_kernel_m, nearest);
  for (Candidate& c : candidates) {
    const Eigen::Vector2d arm = c.p_map - robot;
    c.p_aligned = alignment.apply(c.p_map, robot);
    c.aligned_covariance =
        c.covariance - swept(pose_covariance, arm) + swept(alignment.covariance, arm);
  }
}

void Mapper::Impl::pair_with_landmarks(const std::vector<Candidate>& candidates,
                                       std::vector<Pairing>& pairs,
                                       std::vector<char>& explained) const {
  const double gate2 = config.gate_sigma * config.gate_sigma;
  std::vector<Pairing> possible;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const Candidate& c = candidates[k];
    const Detection& d = *c.detection;
    grid.near(c.p_aligned.x(), c.p_aligned.y(), config.gate_m, [&](std::int32_t i) {
      const Record& r = records[static_cast<std::size_t>(i)];
      const Eigen::Vector2d delta = c.p_aligned - Eigen::Vector2d(r.anchor_x_m, r.anchor_y_m);
      if (delta.squaredNorm() > config.gate_m * config.gate_m) return;
      const double width_difference_m = d.width_m - r.width_m;
      if (std::abs(width_difference_m) > config.width_gate_m) return;
      Eigen::Matrix2d covariance = c.aligned_covariance;
      covariance.diagonal().array() += r.scatter_m2 + 1.0 / r.anchor_information;
      const double mahalanobis2 = delta.dot(covariance.inverse() * delta);
      if (mahalanobis2 > gate2) return;
      const double width_sd_m =
          std::hypot(d.width_sd_m, kWidthRelativeSd * std::max<double>(r.width_m, d.width_m));
      const double width_term = width_difference_m / std::max(width_sd_m, 1e-3);
      // the determinant keeps a vague landmark from winning by its vagueness
      const double cost = mahalanobis2 + std::log(covariance.determinant()) +
                          std::min(9.0, width_term * width_term);
      possible.push_back({cost, i, k});
    });
  }
  std::sort(possible.begin(), possible.end(), [](const Pairing& a, const Pairing& b) {
    if (a.cost != b.cost) return a.cost < b.cost;
    return a.landmark != b.landmark ? a.landmark < b.landmark : a.candidate < b.candidate;
  });
  std::vector<std::int32_t> taken;
  std::vector<char> is_paired(candidates.size(), 0);
  explained.assign(candidates.size(), 0);
  for (const Pairing& p : possible) {
    explained[p.candidate] = 1;
    if (is_paired[p.candidate]) continue;
    if (std::find(taken.begin(), taken.end(), p.landmark) != taken.end()) continue;
    taken.push_back(p.landmark);
    is_paired[p.candidate] = 1;
    pairs.push_back(p);
  }
}

std::int32_t Mapper::Impl::create(const Candidate& candidate) {
  if (records.size() >= static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max() - 1)) {
    throw std::length_error("mapper: more landmarks than ids");
  }
  const auto index = static_cast<std::int32_t>(records.size());
  Record r;
  r.anchor_x_m = candidate.p_aligned.x();
  r.anchor_y_m = candidate.p_aligned.y();
  r.width_m = static_cast<float>(candidate.detection->width_m);
  // grown by a quarter: doubling could leave half of a large map's memory unused
  if (records.size() == records.capacity()) records.reserve(records.size() + records.size() / 4 + 64);
  records.push_back(r);
  grid.insert(index, r.anchor_x_m, r.anchor_y_m);
  ++num_alive;
  return index;
}

void Mapper::Impl::accumulate(Record& r, const Eigen::Vector2d& p_map, double roc_tree,
                              Label label) const {
  if (label != Label::kUnseen && !r.is_seen) {
    // what follows are statistics of camera-seen observations alone, as the paper's tables are
    r.is_seen = true;
    r.num_observations = 0;
    r.mean_x_m = r.mean_y_m = r.roc_sum = 0.0;
    r.m2_xx = r.m2_xy = r.m2_yy = 0.0f;
  }
  if (label == Label::kUnseen && r.is_seen) return;
  ++r.num_observations;
  const double n = r.num_observations;
  const double dx = p_map.x() - r.mean_x_m;
  const double dy = p_map.y() - r.mean_y_m;
  r.mean_x_m += dx / n;
  r.mean_y_m += dy / n;
  r.m2_xx += static_cast<float>(dx * (p_map.x() - r.mean_x_m));
  r.m2_xy += static_cast<float>(dx * (p_map.y() - r.mean_y_m));
  r.m2_yy += static_cast<float>(dy * (p_map.y() - r.mean_y_m));
  r.roc_sum += roc_tree;
  if (label == Label::kUnseen) return;
  const double of_tree = config.tree_rate_of_trees;
  const double of_object = config.tree_rate_of_objects;
  const double evidence = label == Label::kTree ? std::log(of_tree / of_object)
                                                : std::log((1.0 - of_tree) / (1.0 - of_object));
  r.log_odds = static_cast<float>(std::clamp(r.log_odds + evidence, -kLogOddsMax, kLogOddsMax));
}

void Mapper::Impl::observe(std::int32_t index, const Candidate& c) {
  Record& r = records[static_cast<std::size_t>(index)];
  const Detection& d = *c.detection;
  const double variance_m2 = std::max(1e-6, 0.5 * c.aligned_covariance.trace());
  const double information = 1.0 / variance_m2;
  const double total = r.anchor_information + information;
  const double share = information / total;
  const Eigen::Vector2d delta = c.p_aligned - Eigen::Vector2d(r.anchor_x_m, r.anchor_y_m);
  r.scatter_m2 = static_cast<float>((1.0 - share) *
                                    (r.scatter_m2 + share * 0.5 * delta.squaredNorm()));
  const double to_x_m = r.anchor_x_m + share * delta.x();
  const double to_y_m = r.anchor_y_m + share * delta.y();
  grid.move(index, r.anchor_x_m, r.anchor_y_m, to_x_m, to_y_m);
  r.anchor_x_m = to_x_m;
  r.anchor_y_m = to_y_m;
  r.anchor_information = static_cast<float>(total);

  const double width_sd_m = std::max(d.width_sd_m, 0.005);
  const double width_information = 1.0 / (width_sd_m * width_sd_m);
  r.width_information += static_cast<float>(width_information);
  r.width_m += static_cast<float>(width_information / r.width_information * (d.width_m - r.width_m));

  Observation o;
  o.scan = static_cast<std::int32_t>(scans.size()) - 1;
  o.previous = r.last_observation;
  o.x_base_m = static_cast<float>(d.centre_x_m);
  o.y_base_m = static_cast<float>(d.centre_y_m);
  o.sd_m = static_cast<float>(std::sqrt(0.5 * c.covariance.trace()));
  o.roc_tree = static_cast<float>(d.roc_tree);
  o.width_m = static_cast<float>(d.width_m);
  o.label = static_cast<std::int8_t>(d.label);
  r.last_observation = static_cast<std::int32_t>(observations.size());
  observations.push_back(o);

  r.last_scan = o.scan;
  ++r.num_all;
  accumulate(r, c.p_map, d.roc_tree, d.label);
}

std::int32_t Mapper::Impl::merge_partner(std::int32_t index) const {
  const Record& r = records[static_cast<std::size_t>(index)];
  std::int32_t best = -1;
  double best_m2 = config.merge_m * config.merge_m;
  grid.near(r.anchor_x_m, r.anchor_y_m, config.merge_m, [&](std::int32_t i) {
    const Record& other = records[static_cast<std::size_t>(i)];
    // two things in one scan are two things
    if (i == index || other.last_scan == r.last_scan) return;
    if (std::abs(other.width_m - r.width_m) > config.width_gate_m) return;
    const double dx = other.anchor_x_m - r.anchor_x_m;
    const double dy = other.anchor_y_m - r.anchor_y_m;
    const double distance_m2 = dx * dx + dy * dy;
    if (distance_m2 < best_m2 || (distance_m2 == best_m2 && best >= 0 && i < best)) {
      best_m2 = distance_m2;
      best = i;
    }
  });
  return best;
}

void Mapper::Impl::merge(std::int32_t keep, std::int32_t drop) {
  Record& a = records[static_cast<std::size_t>(keep)];
  Record& b = records[static_cast<std::size_t>(drop)];
  grid.remove(drop, b.anchor_x_m, b.anchor_y_m);
  const double total = a.anchor_information + b.anchor_information;
  const double share = b.anchor_information / total;
  const double dx = b.anchor_x_m - a.anchor_x_m;
  const double dy = b.anchor_y_m - a.anchor_y_m;
  a.scatter_m2 = static_cast<float>((1.0 - share) * a.scatter_m2 + share * b.scatter_m2 +
                                    share * (1.0 - share) * 0.5 * (dx * dx + dy * dy));
  grid.move(keep, a.anchor_x_m, a.anchor_y_m, a.anchor_x_m + share * dx,
            a.anchor_y_m + share * dy);
  a.anchor_x_m += share * dx;
  a.anchor_y_m += share * dy;
  a.anchor_information = static_cast<float>(total);
  a.width_m = (a.width_m * a.width_information + b.width_m * b.width_information) /
              (a.width_information + b.width_information);
  a.width_information += b.width_information;
  if (b.is_seen && !a.is_seen) {
    std::swap(a.mean_x_m, b.mean_x_m);
    std::swap(a.mean_y_m, b.mean_y_m);
    std::swap(a.m2_xx, b.m2_xx);
    std::swap(a.m2_xy, b.m2_xy);
    std::swap(a.m2_yy, b.m2_yy);
    std::swap(a.roc_sum, b.roc_sum);
    std::swap(a.num_observations, b.num_observations);
    a.is_seen = true;
  } else if (a.is_seen == b.is_seen) {  // sums of two samples (Chan et al. 1979)
    const double n_a = a.num_observations;
    const double n_b = b.num_observations;
    const double x_m = b.mean_x_m - a.mean_x_m;
    const double y_m = b.mean_y_m - a.mean_y_m;
    const double scale = n_a * n_b / (n_a + n_b);
    a.m2_xx += static_cast<float>(b.m2_xx + scale * x_m * x_m);
    a.m2_xy += static_cast<float>(b.m2_xy + scale * x_m * y_m);
    a.m2_yy += static_cast<float>(b.m2_yy + scale * y_m * y_m);
    a.mean_x_m += n_b / (n_a + n_b) * x_m;
    a.mean_y_m += n_b / (n_a + n_b) * y_m;
    a.num_observations += b.num_observations;
    a.roc_sum += b.roc_sum;
  }
  a.log_odds = static_cast<float>(
      std::clamp<double>(a.log_odds + b.log_odds, -kLogOddsMax, kLogOddsMax));
  a.num_all += b.num_all;
  a.last_scan = std::max(a.last_scan, b.last_scan);
  std::int32_t tail = b.last_observation;
  while (observations[static_cast<std::size_t>(tail)].previous >= 0) {
    tail = observations[static_cast<std::size_t>(tail)].previous;
  }
  observations[static_cast<std::size_t>(tail)].previous = a.last_observation;
  a.last_observation = b.last_observation;
  b = Record{};
  b.is_removed = true;
  --num_alive;
}

Landmark Mapper::Impl::report(std::int32_t index) const {
  const Record& r = records[static_cast<std::size_t>(index)];
  Landmark l;
  l.id = index + 1;
  l.num_observations = r.num_observations;
  l.width_m = r.width_m;
  const double n = r.num_observations;
  l.roc_mean = r.roc_sum / n;
  l.probability = 1.0 / (1.0 + std::exp(-static_cast<double>(r.log_odds)));
  l.label = !r.is_seen ? Label::kUnseen : r.log_odds > 0.0f ? Label::kTree : Label::kObject;
  if (r.num_observations > 1) {
    const double scale = 1.0 / (n * (n - 1.0));
    l.se_x_m = std::sqrt(std::max(0.0, scale * r.m2_xx));
    l.se_y_m = std::sqrt(std::max(0.0, scale * r.m2_yy));
  }

  struct Sample {
    Eigen::Vector2d p;
    double weight = 0.0;
  };
  std::vector<Sample> samples;
  samples.reserve(std::min(kSamplesMost, static_cast<std::size_t>(r.num_all)));
  for (std::int32_t k = r.last_observation; k >= 0;
       k = observations[static_cast<std::size_t>(k)].previous) {
    const Observation& o = observations[static_cast<std::size_t>(k)];
    const pose::PoseEstimate& pose = scans[static_cast<std::size_t>(o.scan)].T_map_base;
    const mrpt::poses::CPose3D T_map_base(pose.x_m, pose.y_m, 0.0, pose.yaw_rad, pose.pitch_rad,
                                          pose.roll_rad);
    Sample sample;
    double z = 0.0;
    T_map_base.composePoint(o.x_base_m, o.y_base_m, 0.0, sample.p.x(), sample.p.y(), z);
    sample.weight = 1.0 / std::max(1e-6, static_cast<double>(o.sd_m) * o.sd_m);
    samples.push_back(sample);
    if (samples.size() == kSamplesMost) break;
  }
  // towards the bulk: from the mean, with a kernel that shrinks to its configured width
  Eigen::Vector2d centre(r.mean_x_m, r.mean_y_m);
  double sum = 0.0;
  double sum2 = 0.0;
  for (int round = 0; round < kCentreRounds; ++round) {
    const double kernel_m = config.centre_kernel_m * std::max(1.0, 4.0 - 0.5 * round);
    Eigen::Vector2d next = Eigen::Vector2d::Zero();
    sum = sum2 = 0.0;
    for (const Sample& s : samples) {
      const double u2 = (s.p - centre).squaredNorm() / (kernel_m * kernel_m);
      const double weight = s.weight * std::exp(-0.5 * std::min(u2, 60.0));
      next += weight * s.p;
      sum += weight;
      sum2 += weight * weight;
    }
    centre = next / sum;
  }
  l.x_m = centre.x();
  l.y_m = centre.y();
  if (samples.size() == 1) {
    const double variance_m2 = 1.0 / samples.front().weight;
    l.covariance = {variance_m2, 0.0, variance_m2};
  } else {
    Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
    for (const Sample& s : samples) {
      const Eigen::Vector2d delta = s.p - centre;
      const double u2 = delta.squaredNorm() / (config.centre_kernel_m * config.centre_kernel_m);
      scatter += s.weight * std::exp(-0.5 * std::min(u2, 60.0)) * delta * delta.transpose();
    }
    const double effective = std::max(1.0, sum * sum / sum2);
    scatter /= sum * std::max(1.0, effective - 1.0);
    l.covariance = {scatter(0, 0), scatter(0, 1), scatter(1, 1)};
  }
  return l;
}

Mapper::Mapper(const MapperConfig& config) : impl_(std::make_unique<Impl>(config)) {}
Mapper::~Mapper() = default;
Mapper::Mapper(Mapper&&) noexcept = default;
Mapper& Mapper::operator=(Mapper&&) noexcept = default;

MapUpdate Mapper::update(const detection::Detections& detections,
                         const pose::PoseEstimate& T_map_base) {
  Impl& m = *impl_;
  m.scans.push_back({detections.utime, T_map_base});
  std::vector<Candidate> candidates = m.candidates_of(detections, T_map_base);
  if (m.config.align_scans) m.align(candidates, T_map_base);

  std::vector<Pairing> pairs;
  std::vector<char> explained;
  m.pair_with_landmarks(candidates, pairs, explained);
  MapUpdate update;
  for (const Pairing& pair : pairs) {
    m.observe(pair.landmark, candidates[pair.candidate]);
    update.changed_ids.push_back(pair.landmark + 1);
  }
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (explained[k]) continue;
    const std::int32_t index = m.create(candidates[k]);
    m.observe(index, candidates[k]);
    update.changed_ids.push_back(index + 1);
  }
  std::sort(update.changed_ids.begin(), update.changed_ids.end());
  for (std::size_t k = 0; k < update.changed_ids.size(); ++k) {
    const std::int32_t index = update.changed_ids[k] - 1;
    if (m.records[static_cast<std::size_t>(index)].is_removed) continue;
    const std::int32_t other = m.merge_partner(index);
    if (other < 0) continue;
    m.merge(std::min(index, other), std::max(index, other));
    update.removed_ids.push_back(std::max(index, other) + 1);
    update.changed_ids.push_back(std::min(index, other) + 1);
  }
  std::vector<std::int32_t>& ids = update.changed_ids;
  ids.erase(std::remove_if(ids.begin(), ids.end(),
                           [&](std::int32_t id) {
                             return m.records[static_cast<std::size_t>(id - 1)].is_removed;
                           }),
            ids.end());
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  std::sort(update.removed_ids.begin(), update.removed_ids.end());
  return update;
}

Landmark Mapper::landmark(std::int32_t id) const {
  if (id < 1 || static_cast<std::size_t>(id) > impl_->records.size() ||
      impl_->records[static_cast<std::size_t>(id - 1)].is_removed) {
    throw std::out_of_range("no landmark with id " + std::to_string(id));
  }
  return impl_->report(id - 1);
}

std::size_t Mapper::num_landmarks() const { return impl_->num_alive; }

std::size_t Mapper::num_bytes() const {
  return impl_->records.capacity() * sizeof(Record) + impl_->grid.num_bytes();
}

std::vector<std::int32_t> Mapper::ids_from(std::int32_t first_id, std::size_t count) const {
  std::vector<std::int32_t> ids;
  for (std::size_t i = static_cast<std::size_t>(std::max(1, first_id)) - 1;
       i < impl_->records.size() && ids.size() < count; ++i) {
    if (!impl_->records[i].is_removed) ids.push_back(static_cast<std::int32_t>(i) + 1);
  }
  return ids;
}

std::vector<Landmark> Mapper::landmarks(int min_observations) const {
  std::vector<Landmark> all;
  for (std::size_t i = 0; i < impl_->records.size(); ++i) {
    const Record& r = impl_->records[i];
    if (r.is_removed || r.num_observations < min_observations) continue;
    all.push_back(impl_->report(static_cast<std::int32_t>(i)));
  }
  return all;
}

}  // namespace orchard::mapping
