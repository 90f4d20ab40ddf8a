// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "geometry/georeference.hpp"
#include "pose/attitude/ground_profile.hpp"
#include "pose/filter/gnss_positions.hpp"
#include "pose/pose_estimate.hpp"
#include "text/finding.hpp"

namespace orchard::pose {

/// What the satellite fixes of a drive tell of its path.
struct OnEarth {
  std::size_t num_fixes = 0;
  std::optional<geometry::Georeference> place;  ///< of map
  GroundProfile ground;                         ///< along the path
  /// path_contradicts_fixes: the path lies beside more than a tenth of the fixes, by more than they
  /// err.
  std::optional<Finding> doubt;
};

/// Returns the pose of a corrected path at a time; none where the path has a gap.
using PathAt = std::function<std::optional<PoseEstimate>(std::int64_t utime)>;

/// Keeps the fixes and tilts of a drive, to register its corrected path to the earth.
class FixesOfDrive {
 public:
  explicit FixesOfDrive(const GnssConfig& config);

  /// Takes a fix; returns whether it is usable. Of a robot that stands only one is kept.
  bool add(const Gnss& gnss);

  /// Whether the last tilt is long enough ago for another one.
  bool wants_tilt_at(std::int64_t utime) const;
  void add_tilt(std::int64_t utime, const Attitude& tilt);

  /// Number of fixes kept.
  std::size_t size() const { return fixes_.size(); }

  /// Reads the fixes along a path, in time proportional to the drive.
  OnEarth along(const PathAt& path_at) const;

 private:
  struct Tilt {
    std::int64_t utime;
    Attitude attitude;
  };
  std::optional<GnssAlignment> alignment_of(const PathAt& path_at) const;
  GroundProfile ground_along(const PathAt& path_at) const;

  Eigen::Vector3d p_base_antenna_m_;
  GnssPositions gnss_;
  std::vector<GnssPosition> fixes_;
  std::vector<Tilt> tilts_;
};

}  // namespace orchard::pose
