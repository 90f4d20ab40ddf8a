// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "detection/motion.hpp"
#include "detection/rig.hpp"
#include "mapping/album/album_config.hpp"
#include "mapping/album/photograph.hpp"
#include "pose/pose_estimate.hpp"
#include "vision/image.hpp"

namespace orchard::mapping {

/// Keeps the sharpest unoccluded view of every object in scans with images, in bounded memory.
///
/// One passing of one position gives one view, the best. Views are assigned to landmarks only when
/// the map is written (choose_photographs()), because the path may be corrected until then. Scans
/// are processed in the order of add_scan(), each when its image is there, regardless of the order
/// in which scans and images arrive.
class Album {
 public:
  Album(const AlbumConfig& config, const detection::Rig& rig);

  /// Whether photographs are enabled and a camera exists.
  bool is_open() const { return max_bytes_ > 0; }

  /// Whether an image of that time will be examined; others need not be added.
  bool keeps_picture(std::int64_t utime) const;

  /// Adds a scan that was paired with the image of `image_utime` (0: none). `motion`: of base
  /// around that time.
  void add_scan(std::int64_t utime, std::int64_t image_utime, const pose::PoseEstimate& T_map_base,
                const detection::Motion& motion, std::vector<Subject> subjects);
  void add_picture(const vision::Image& image);

  /// Ends the input: drops scans that wait for an image.
  void flush();

  /// All photographs, placed with the current poses; without those at times without a pose.
  std::vector<PlacedPhotograph> photographs(
      const std::function<std::optional<pose::PoseEstimate>(std::int64_t)>& pose_at) const;

  std::size_t max_bytes() const { return max_bytes_; }
  std::size_t num_bytes() const { return num_bytes_; }

 private:
  struct WaitingScan {
    std::int64_t utime = 0;
    std::int64_t image_utime = 0;
    double x_m = 0.0, y_m = 0.0, yaw_rad = 0.0;
    detection::Motion motion;
    std::vector<Subject> subjects;
  };
  /// Best view of one position in one passing.
  struct Passing {
    double x_m = 0.0, y_m = 0.0;  ///< in map, by the pose at that time
    std::int64_t last_utime = 0;
    Photograph best;
  };
  void take_scans();
  void observe(const WaitingScan& scan, const vision::Image& image);
  std::size_t passing_at(double x_m, double y_m, std::int64_t utime);
  void drop_worst_photographs();

  detection::Rig rig_;
  std::size_t max_bytes_;
  std::vector<WaitingScan> scans_;       ///< in order of arrival
  std::vector<vision::Image> pictures_;  ///< likewise
  std::vector<Passing> passings_;        ///< in order of their start
  std::size_t num_over_ = 0;             ///< number of passings at the front that have ended
  std::size_t num_bytes_ = 0;            ///< total of all photographs
  std::optional<std::int64_t> last_picture_utime_;
};

}  // namespace orchard::mapping
