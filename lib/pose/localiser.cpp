// SPDX-License-Identifier: BSD-3-Clause
#include "pose/localiser.hpp"

#include <optional>
#include <utility>

#include "pose/filter/fusion.hpp"
#include "pose/pose_config.hpp"
#include "pose/prior_map/prior_map_localiser.hpp"
#include "pose/scan_matching/scan_motion.hpp"
#include "pose/slam/trunk_slam.hpp"

namespace orchard::pose {
namespace {

/// Localiser of a robot that stands at the map's origin: every measurement gives the origin at its
/// utime.
class Stationary : public Localiser {
 public:
  void add(const Measurement& measurement) override {
    PoseEstimate origin;
    origin.utime = utime_of(measurement);
    estimate_ = origin;
  }
  std::optional<PoseEstimate> estimate() const override { return estimate_; }

 private:
  std::optional<PoseEstimate> estimate_;
};

}  // namespace

std::unique_ptr<Localiser> make_localiser(const PoseConfig& config, const PriorMapData& earlier,
                                          const laser::LaserConfig& laser,
                                          const laser::BlindSector& blind,
                                          std::shared_ptr<ChunkAllocator> memory) {
  switch (config.mode) {
    case PoseMode::kStationary:
      return std::make_unique<Stationary>();
    case PoseMode::kFixes:
      return std::make_unique<Fixes>(config);
    case PoseMode::kPriorMap:
      return std::make_unique<PriorMapLocaliser>(config, earlier, laser, blind);
    case PoseMode::kSlam:
      return std::make_unique<TrunkSlam>(config, laser, blind, std::move(memory));
    case PoseMode::kOdometry:
    case PoseMode::kFixesAndOdometry:
    case PoseMode::kFused:
      break;
  }
  if (reads_scans(config)) {
    return std::make_unique<ScanOdometry>(config, laser, blind);
  }
  return std::make_unique<Fusion>(as_fused(config));
}

}  // namespace orchard::pose
