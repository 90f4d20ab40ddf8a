// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "laser/laser_config.hpp"
#include "laser/scan.hpp"
#include "pose/filter/gnss_positions.hpp"
#include "pose/measurements.hpp"
#include "pose/pose_config.hpp"
#include "pose/rig/antenna_estimate.hpp"
#include "pose/rig/mount_estimate.hpp"
#include "pose/rig/reference_path.hpp"
#include "pose/scan_matching/scan_motion.hpp"
#include "text/finding.hpp"

namespace orchard::pose {

/// What a rig states of where its sensors are.
struct RigFacts {
  laser::LaserConfig laser;
  laser::RearLaserConfig laser_rear;
  laser::BlindSector blind;
  ScanMotionConfig scan_motion;
  GnssConfig gnss;
};

/// What a drive tells about the rig; none where nothing tells it.
struct RigEstimates {
  std::optional<MountEstimate> laser, laser_rear;
  bool by_wheels = false;  ///< compared with the wheels, else with fixes
  std::optional<AntennaEstimate> antenna;
  double scans_determined = 0.0;  ///< fraction of the motions between scans that these determine
};

/// Path of one scanner by matching its scans every few decimetres, in pieces, each compared with
/// the reference. It ends after some hundred metres: the rig is known by then, and matching costs.
class ScannerPath {
 public:
  /// `stated`: the mount by the rig; only a first guess of each motion depends on it.
  ScannerPath(const ScanMotionConfig& config, const laser::BlindSector& blind,
              const laser::LaserConfig& stated);

  /// Takes a scan; it is used as soon as the reference has reached its time.
  void add(const laser::Scan& scan);
  /// Uses the scans that the reference has reached, or all at the end.
  void advance(const ReferencePath& reference, bool ended);

  bool is_complete() const;
  const std::vector<MotionPair>& pairs() const { return pairs_; }
  /// The time of the oldest scan that waits, or of the present stretch's start; none: neither.
  std::optional<std::int64_t> oldest_utime() const;

  /// A matched scan.
  struct Key {
    std::int64_t utime = 0;
    Eigen::Vector3d T_path_laser = Eigen::Vector3d::Zero();
    int piece = 0;  ///< the path is consistent within a piece
  };
  const std::vector<Key>& keys() const { return keys_; }
  /// Fraction of the scans whose motion they determine, without the wheels.
  double determined() const {
    return keys_.empty() ? 0.0 : 1.0 - static_cast<double>(num_lost_) / keys_.size();
  }

 private:
  /// The reference at a time and shortly before and after it.
  struct Anchor {
    std::int64_t utime = 0;
    ReferencePath::Place place;
    std::optional<ReferencePath::Place> before, after;
  };
  static std::optional<Anchor> anchor_at(const ReferencePath& reference, std::int64_t utime);
  void use(const laser::Scan& scan, const std::optional<Anchor>& anchor);
  void match(const laser::Scan& scan, const Anchor& anchor);
  void end_stretch(const Anchor& anchor);

  PoseConfig config_;
  laser::BlindSector blind_;
  ScanMotion motion_;
  Eigen::Vector3d T_base_laser_;
  std::deque<laser::Scan> waiting_;
  std::optional<Anchor> last_key_, stretch_start_;
  Eigen::Vector3d T_start_laser_ = Eigen::Vector3d::Zero();
  std::vector<MotionPair> pairs_;
  std::size_t num_straight_ = 0;
  std::vector<Key> keys_;
  std::size_t num_lost_ = 0;  ///< keys whose scans did not determine the motion
};

/// Compares what the rig states with what its drive shows: the scanners' motion against the wheels'
/// or the fixes', and the satellite fixes against the scanner's path. A finding is raised if the
/// difference is beyond doubt and larger than a person measures with ruler and eye: laser_yaw,
/// laser_mount, mirrored, scanners_exchanged, wheels_scale, wheels_delay, antenna.
///
/// A pure function of the measurements of each kind; how the kinds are interleaved matters only
/// where a message is more than two hundred scans late.
class RigMonitor {
 public:
  explicit RigMonitor(const RigFacts& facts);

  void add(const Odometry& odometry);
  void add(const PoseFix& fix);
  void add(const Gnss& gnss);
  void add(const laser::Scan& scan);
  void add_rear(const laser::Scan& scan);
  /// Ends the input and judges what there is.
  void finish();

  const std::vector<Finding>& findings() const { return findings_; }
  const RigEstimates& estimates() const { return estimates_; }

 private:
  const ReferencePath* reference() const;
  void advance(bool ended);
  void judge();
  std::vector<std::vector<AntennaView>> antenna_views() const;

  RigFacts facts_;
  ReferencePath wheels_, fixes_;
  bool has_wheels_ = false, has_fixes_ = false;
  ScannerPath front_, rear_;
  GnssPositions gnss_;
  std::vector<GnssPosition> positions_;
  std::size_t next_judgement_;
  RigEstimates estimates_;
  std::vector<Finding> findings_;
};

}  // namespace orchard::pose
