// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/free_space.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"
#include "mapping/tuning.hpp"

namespace orchard::mapping {
namespace {

/// derived: Extent of the position uncertainty, in standard deviations.
constexpr double kPosition_sigma = 2.0;

using Eigen::Vector2d;

// derived: codes of a byte; from 1 to kFarthest they are ranges.
constexpr std::uint8_t kSaysNothing = 0;
constexpr std::uint8_t kFarthest = 253;
constexpr std::uint8_t kBeyondReach = 254;
constexpr std::uint8_t kNoReturn = 255;

/// derived: Returns this far before or behind a circle still belong to the object: bark is rough
/// and trunks are not round.
constexpr double kRough_m = 0.05;
/// derived: Minimum number of beams across the object's own width, all of which must pass.
constexpr int kFewestAcross = 2;
/// derived: Half the beam spacing, in beams.
constexpr double kOneBeam = 0.5;

}  // namespace

FreeSpace::FreeSpace(const laser::Scan& scan, const laser::LaserConfig& laser,
                     const laser::BlindSector& blind)
    : utime_(scan.utime),
      laser_(laser),
      bearing_middle_rad_(scan.bearing_min_rad +
                          0.5 * (static_cast<double>(scan.ranges_m.size()) - 1) *
                              scan.bearing_step_rad),
      bearing_step_rad_(scan.bearing_step_rad),
      beam_period_s_(1e-6 * scan.beam_period_us),
      no_return_m_(0.5 * scan.range_max_m),
      over_ground_(scan.over_ground) {
  laser_.mount_x_m += scan.sway_x_m;
  laser_.mount_y_m += scan.sway_y_m;
  codes_.assign(scan.ranges_m.size(), kSaysNothing);
  const double per_m = kFarthest / kBeamReach_m;
  for (std::size_t k = 0; k < codes_.size(); ++k) {
    const std::size_t i = scan.beam_near(k);
    const double range_m = scan.ranges_m[i];
    if (blind.contains(scan.bearing_rad(static_cast<double>(i)))) continue;
    if (range_m == 0.0 || range_m >= scan.range_max_m) {  // some drivers report no return as max
      codes_[k] = kNoReturn;
    } else if (scan.valid(i) && range_m >= kBeamReach_m) {
      codes_[k] = kBeyondReach;
    } else if (scan.valid(i)) {
      codes_[k] =
          std::min<std::uint8_t>(kFarthest, static_cast<std::uint8_t>(1.0 + range_m * per_m));
    }
  }
}

namespace {

/// Calls visit(address, size) for each value.
template <class... Values, class Visit>
void visit_each(Visit&& visit, Values&... values) {
  (visit(&values, sizeof(values)), ...);
}

}  // namespace

std::vector<std::uint8_t> FreeSpace::pack() const {
  std::vector<std::uint8_t> bytes;
  visit_each(
      [&bytes](const void* value, std::size_t size) {
        const auto* first = static_cast<const std::uint8_t*>(value);
        bytes.insert(bytes.end(), first, first + size);
      },
      utime_, laser_, bearing_middle_rad_, bearing_step_rad_, beam_period_s_, no_return_m_,
      velocity_.x(), velocity_.y(), velocity_.z(), over_ground_);
  bytes.insert(bytes.end(), codes_.begin(), codes_.end());
  return bytes;
}

FreeSpace FreeSpace::unpack(const std::vector<std::uint8_t>& bytes) {
  FreeSpace free_space;
  std::size_t next = 0;
  visit_each(
      [&](void* value, std::size_t size) {
        if (next + size > bytes.size()) throw std::length_error("free space: too few bytes");
        std::memcpy(value, bytes.data() + next, size);
        next += size;
      },
      free_space.utime_, free_space.laser_, free_space.bearing_middle_rad_,
      free_space.bearing_step_rad_, free_space.beam_period_s_, free_space.no_return_m_,
      free_space.velocity_.x(), free_space.velocity_.y(), free_space.velocity_.z(),
      free_space.over_ground_);
  free_space.codes_.assign(bytes.begin() + static_cast<std::ptrdiff_t>(next), bytes.end());
  return free_space;
}

Clearance FreeSpace::clearance(const Vector2d& p_base) const {
  if (!over_ground_.is_known()) return Clearance::kUntold;
  const Eigen::Vector2f p = (p_base - Vector2d(laser_.mount_x_m, laser_.mount_y_m)).cast<float>();
  return over_ground_.may_be_ground(p.x(), p.y()) ? Clearance::kLow : Clearance::kClear;
}

/// Transforms a point from base (at the scan's utime) to the laser frame at the time of a beam.
Vector2d FreeSpace::in_laser(const Vector2d& p_base, double beam) const {
  const double time_s = beam_period_s_ * beam;
  const Vector2d arm = p_base - time_s * velocity_.head<2>();
  const Vector2d p = geometry::rotation(time_s * velocity_.z()).transpose() * arm;
  return inverse_transform(
      geometry::Pose2{laser_.mount_x_m, laser_.mount_y_m, laser_.mount_yaw_rad}, p);
}

/// Fractional index of the beam towards a point.
double FreeSpace::beam_of(const Vector2d& p_laser) const {
  const double bearing_rad = std::atan2(p_laser.y(), p_laser.x());
  return 0.5 * (static_cast<double>(codes_.size()) - 1) +
         geometry::wrap_angle_rad(bearing_rad - bearing_middle_rad_) / bearing_step_rad_;
}

double FreeSpace::bearing_of(double beam) const {
  return bearing_middle_rad_ +
         (beam - 0.5 * (static_cast<double>(codes_.size()) - 1)) * bearing_step_rad_;
}

/// Whether a beam is known to go on beyond a range.
bool FreeSpace::is_beyond(std::uint8_t code, double range_m) const {
  if (code == kBeyondReach) return true;
  if (code == kNoReturn) return range_m < no_return_m_;
  return code != kSaysNothing && (code - 0.5) * kBeamReach_m / kFarthest > range_m;
}

PassageBeams FreeSpace::through(const Vector2d& from_base, const Vector2d& to_base,
                                double half_depth_m, double clear_m) const {
  if (codes_.empty()) return {};
  const double last = static_cast<double>(codes_.size()) - 1;
  const double middle = beam_of(in_laser(0.5 * (from_base + to_base), 0.0));
  const double sent_at = std::clamp(middle, 0.0, last);
  const Vector2d from = in_laser(from_base, sent_at), to = in_laser(to_base, sent_at);
  const double length_m = (to - from).norm();
  const Vector2d along = (to - from) / std::max(1e-9, length_m);
  Vector2d across(-along.y(), along.x());
  if (from.dot(across) < 0.0) across = -across;
  const double side_m = from.dot(across);  // of the laser, from the line
  const double range_m = (0.5 * (from + to)).norm(),
               half_m = std::hypot(0.5 * length_m, half_depth_m);
  PassageBeams beams;
  if (range_m <= half_m || range_m + half_m > kBeamReach_m) return beams;
  const double half_beams = std::asin(half_m / range_m) / std::abs(bearing_step_rad_);
  const auto is_between = [&](double s_m) { return s_m >= 0.0 && s_m <= length_m; };
  for (double k = std::ceil(std::max(0.0, middle - half_beams));
       k <= std::min(last, middle + half_beams); ++k) {
    const std::uint8_t code = codes_[static_cast<std::size_t>(k)];
    const double bearing_rad = bearing_of(k);
    const Vector2d ray(std::cos(bearing_rad), std::sin(bearing_rad));
    if (code >= 1 && code <= kFarthest) {
      const Vector2d hit = (code - 0.5) * kBeamReach_m / kFarthest * ray - from;
      beams.num_within += is_between(hit.dot(along)) && std::abs(hit.dot(across)) <= half_depth_m;
    }
    const double per_m = std::max(1e-9, ray.dot(across));
    const double enters_m = (side_m - half_depth_m) / per_m,
                 leaves_m = (side_m + half_depth_m) / per_m;
    const bool crosses = side_m > half_depth_m && is_between((enters_m * ray - from).dot(along)) &&
                         is_between((leaves_m * ray - from).dot(along));
    beams.num_through += crosses && is_beyond(code, leaves_m + clear_m);
  }
  return beams;
}

FreeSpaceAnswer FreeSpace::at(const Vector2d& p_base, double width_m, double sd_m) const {
  if (codes_.empty()) return {};
  const double last = static_cast<double>(codes_.size()) - 1;
  Vector2d p = in_laser(p_base, 0.0);
  double middle = beam_of(p);
  if (is_sweep()) {
    p = in_laser(p_base, std::clamp(middle, 0.0, last));
    middle = beam_of(p);
  }
  const double range_m = p.norm();
  const double along_m = 0.5 * width_m + kRough_m + 0.5 * kBeamReach_m / kFarthest +
                         kPosition_sigma * std::hypot(sd_m, laser_.range_sd_at(range_m));
  const double across_m = 0.5 * width_m + kPosition_sigma * sd_m;
  if (range_m + along_m > kBeamReach_m || range_m < along_m + across_m) return {};
  const double beams_per_rad = 1.0 / std::abs(bearing_step_rad_);
  double reach = std::asin(std::min(1.0, across_m / range_m)) * beams_per_rad;
  double own = std::asin(std::min(1.0, 0.5 * width_m / range_m)) * beams_per_rad;
  // An object as wide as the beam spacing is hit by at least one beam: use the two beams beside its
  // centre.
  if (own >= kOneBeam) own = std::max(own, 1.0);
  reach = std::max(reach, own);
  if (!(middle - reach >= 0.0 && middle + reach <= last)) return {};

  int num = 0, num_past = 0, num_own = 0, num_own_past = 0;
  for (double k = std::ceil(middle - reach); k <= middle + reach; ++k) {
    const std::uint8_t code = codes_[static_cast<std::size_t>(k)];
    bool is_past = code == kBeyondReach || (code == kNoReturn && range_m < no_return_m_);
    if (code >= 1 && code <= kFarthest) {
      const double beam_m = (code - 0.5) * kBeamReach_m / kFarthest;
      if (std::abs(beam_m - range_m) <= along_m) return {FreeSpaceEvidence::kReturns, 0};
      is_past = beam_m > range_m;
    }
    const bool is_own = std::abs(k - middle) <= own;
    ++num;
    num_past += is_past;
    num_own += is_own;
    num_own_past += is_own && is_past;
  }
  const bool sees_past = num_own >= kFewestAcross && num_own_past == num_own &&
                         num_past >= tuning::kPassFraction * num;
  if (!sees_past) return {};
  return {FreeSpaceEvidence::kPassesThrough, num_own};
}

}  // namespace orchard::mapping
