// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/existence/ground_occupancy.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"
#include "mapping/tuning.hpp"

namespace orchard::mapping {
namespace {

/// derived: Positions this close to the path of base were driven over [m]: less than half the width
/// of any vehicle.
constexpr double kDriven_m = 0.25;
/// derived: Scans that moved less than this from the last stored one, and turned less, are skipped:
/// half of kSeenPlace_m, so that other beams cross a position.
constexpr double kMoved_m = 0.1;
constexpr double kTurned_rad = 0.1;
/// derived: half a megabyte.
constexpr std::size_t kUnpackedMax = 512;
/// derived: Radius of the first ring in which scans are looked for [m]; each next one is twice as
/// wide.
constexpr double kFirstRing_m = 2.0;

}  // namespace

void GroundOccupancy::add_scan(std::int32_t scan, const pose::PoseEstimate& T_map_base,
                               bool has_beams) {
  const Eigen::Vector3d pose(T_map_base.x_m, T_map_base.y_m, T_map_base.yaw_rad);
  if (!scans_.empty()) {
    const Eigen::Vector3d& last = scans_.back().x_y_yaw;
    if ((pose - last).head<2>().norm() < kMoved_m &&
        std::abs(geometry::wrap_angle_rad(pose.z() - last.z())) < kTurned_rad) {
      return;
    }
  }
  grid_.insert(static_cast<std::int32_t>(scans_.size()), pose.x(), pose.y());
  scans_.push_back({scan, pose, has_beams});
}

const FreeSpace* GroundOccupancy::free_space(std::int32_t number) {
  const auto known = unpacked_.find(number);
  if (known != unpacked_.end()) return known->second.get();
  if (unpacked_.size() >= kUnpackedMax) unpacked_.clear();
  return unpacked_.emplace(number, free_space_of_(number)).first->second.get();
}

bool GroundOccupancy::Votes::is_passable() const {
  return num_passes >= tuning::kReturnWeight * num_returns;
}

/// Whether the votes that are still to come cannot change the answer.
bool GroundOccupancy::Votes::are_decided() const {
  return num_passes >= tuning::kReturnWeight * (tuning::kVotes - num_passes) ||
         tuning::kReturnWeight * num_returns > tuning::kVotes - num_returns;
}

/// Calls visit(scan, squared distance) for stored scans within reach of the position, nearest
/// first, until it returns false. A few of the hundreds within reach decide, so they are looked for
/// in rings, and a ring is a heap from which only those are taken.
template <class Visit>
void GroundOccupancy::visit_near(const Eigen::Vector2d& p_map, const Visit& visit) {
  double inner_m = -1.0;
  std::vector<std::pair<double, std::int32_t>> ring;  // squared distance and scan
  for (double outer_m = kFirstRing_m; inner_m < kBeamReach_m; outer_m *= 2.0) {
    outer_m = std::min(outer_m, kBeamReach_m);
    ring.clear();
    grid_.near(p_map.x(), p_map.y(), outer_m, [&](std::int32_t i) {
      const Scan& scan = scans_[static_cast<std::size_t>(i)];
      const double square = (scan.x_y_yaw.head<2>() - p_map).squaredNorm();
      if (!scan.has_beams && square > kDriven_m * kDriven_m) return;
      const bool is_in_ring =
          square <= outer_m * outer_m && (inner_m < 0.0 || square > inner_m * inner_m);
      if (is_in_ring) ring.emplace_back(square, i);
    });
    std::make_heap(ring.begin(), ring.end(), std::greater<>());
    while (!ring.empty()) {
      const auto [square, i] = ring.front();
      if (!visit(scans_[static_cast<std::size_t>(i)], square)) return;
      std::pop_heap(ring.begin(), ring.end(), std::greater<>());
      ring.pop_back();
    }
    inner_m = outer_m;
  }
}

void GroundOccupancy::visit_views(
    const Eigen::Vector2d& p_map,
    const std::function<bool(std::int32_t scan, const FreeSpace& beams)>& visit) {
  visit_near(p_map, [&](const Scan& scan, double) {
    const FreeSpace* beams = free_space(scan.number);
    return beams == nullptr || visit(scan.number, *beams);
  });
}

GroundOccupancy::Votes GroundOccupancy::votes_at(const Eigen::Vector2d& p_map) {
  Votes votes;
  visit_near(p_map, [&](const Scan& scan, double square) {
    votes.is_driven = square <= kDriven_m * kDriven_m;  // the nearest tells
    if (votes.is_driven) return false;
    const FreeSpace* beams = free_space(scan.number);
    if (beams == nullptr) return true;
    const auto answer =
        beams->at(geometry::inverse_transform(scan.x_y_yaw, p_map), kSeenPlace_m, 0.0);
    votes.num_passes += answer.evidence == FreeSpaceEvidence::kPassesThrough;
    votes.num_returns += answer.evidence == FreeSpaceEvidence::kReturns;
    return !votes.are_decided();
  });
  return votes;
}

bool GroundOccupancy::is_free(const Eigen::Vector2d& p_map) {
  const Votes votes = votes_at(p_map);
  return votes.is_driven || (votes.num_passes > 0 && votes.is_passable());
}

bool GroundOccupancy::is_open(const Eigen::Vector2d& from_map, const Eigen::Vector2d& to_map,
                              double half_depth_m, double clear_m) {
  int num_scans = 0;
  Votes votes;
  visit_near(0.5 * (from_map + to_map), [&](const Scan& scan, double) {
    const FreeSpace* beams = free_space(scan.number);
    if (beams == nullptr) return true;
    const PassageBeams seen =
        beams->through(geometry::inverse_transform(scan.x_y_yaw, from_map),
                       geometry::inverse_transform(scan.x_y_yaw, to_map), half_depth_m, clear_m);
    if (seen.num_within + seen.num_through == 0) return true;
    votes.num_passes += seen.num_through;
    votes.num_returns += seen.num_within;
    return ++num_scans < tuning::kVotes;
  });
  return votes.num_passes > 0 && votes.is_passable();
}

Passage GroundOccupancy::passage(const Eigen::Vector2d& from_map, const Eigen::Vector2d& to_map,
                                 double half_depth_m, double clear_m) {
  const Votes votes = votes_at(0.5 * (from_map + to_map));
  if (votes.is_driven || is_open(from_map, to_map, half_depth_m, clear_m)) return Passage::kOpen;
  return votes.num_returns > 0 && !votes.is_passable() ? Passage::kShut : Passage::kUnknown;
}

}  // namespace orchard::mapping
