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
#include "mapping/store/state_archive.hpp"
#include "pose/pose_estimate.hpp"
#include "vision/image.hpp"

namespace orchard::mapping {

/// Keeps the sharpest unobstructed view of everything that scans with pictures show, in bounded
/// memory.
///
/// What one passing shows at one place is one thing, of which the best view is kept; whose landmark
/// it is, is asked only when the map is written (choose()): by then the path may have been
/// corrected. Scans are taken in the order of add_scan(), each once its picture is there, whatever
/// the order in which scans and pictures come.
class Album {
 public:
  Album(const AlbumConfig& config, const detection::Rig& rig);

  /// Whether photographs are wanted and can be made.
  bool is_open() const { return max_bytes_ > 0; }

  /// Whether a picture of that time is looked at; others need not be handed over.
  bool keeps_picture(std::int64_t utime) const;

  /// A scan that was paired with the picture of image_utime (0: none). `motion` of base about it.
  void add_scan(std::int64_t utime, std::int64_t image_utime, const pose::PoseEstimate& T_map_base,
                const detection::Motion& motion, std::vector<Subject> subjects);
  void add_picture(const vision::Image& image);

  /// No more pictures come: scans that wait for one are done without.
  void flush();

  /// All photographs, placed by the poses as they are now; those at times without a pose are left
  /// out.
  std::vector<PlacedPhotograph> photographs(
      const std::function<std::optional<pose::PoseEstimate>(std::int64_t)>& pose_at) const;

  std::size_t max_bytes() const { return max_bytes_; }
  std::size_t num_bytes() const { return num_bytes_; }

  /// Its state; the configuration is the maker's.
  void persist(StateArchive& archive);

 private:
  struct WaitingScan {
    std::int64_t utime = 0;
    std::int64_t image_utime = 0;
    double x_m = 0.0, y_m = 0.0, yaw_rad = 0.0;
    detection::Motion motion;
    std::vector<Subject> subjects;
    void persist(StateArchive& archive) {
      archive(utime, image_utime, x_m, y_m, yaw_rad, motion, subjects);
    }
  };
  struct WaitingPicture {
    vision::Image image;
    void persist(StateArchive& archive) {
      archive(image.utime, image.seq, image.width_px, image.height_px, image.encoding, image.data);
    }
  };
  /// What one passing showed at one place.
  struct Passing {
    double x_m = 0.0, y_m = 0.0;  ///< in map, by the pose of that time
    std::int64_t last_utime = 0;
    Photograph best;
    void persist(StateArchive& archive) { archive(x_m, y_m, last_utime, best); }
  };
  void take_scans();
  void observe(const WaitingScan& scan, const vision::Image& image);
  std::size_t passing_at(double x_m, double y_m, std::int64_t utime);
  void make_room();

  detection::Rig rig_;
  std::size_t max_bytes_;
  std::vector<WaitingScan> scans_;        ///< in order of arrival
  std::vector<WaitingPicture> pictures_;  ///< likewise
  std::vector<Passing> passings_;         ///< in order of their beginnings
  std::size_t num_over_ = 0;              ///< of those at the front: none of them goes on
  std::size_t num_bytes_ = 0;             ///< of all photographs
  std::optional<std::int64_t> last_picture_utime_;
};

}  // namespace orchard::mapping
