// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "detection/motion.hpp"
#include "detection/rig.hpp"
#include "mapping/landmark.hpp"
#include "mapping/mapper_config.hpp"
#include "pose/pose_estimate.hpp"
#include "vision/decode.hpp"
#include "vision/image.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::mapping {

/// An object in a scan that may be photographed (base frame at the scan's time).
struct Subject {
  double x_base_m = 0.0;  ///< of its axis
  double y_base_m = 0.0;
  double width_m = 0.0;
  std::int8_t occlusion = 0;  ///< bits of detection::Occlusion
};

/// The best photograph of an object in one passing.
struct Photograph {
  std::int64_t scan_utime = 0;   ///< of the scan, whose pose places the subject
  std::int64_t image_utime = 0;  ///< of the image it was cut out of
  vision::PixelRect frame;       ///< region in that image
  Subject subject;
  double quality = 0.0;
  std::vector<std::uint8_t> jpeg;
};

/// A photograph with the position of its subject, by the current poses.
struct PlacedPhotograph {
  Photograph photograph;
  double x_m = 0.0;
  double y_m = 0.0;
};

/// A landmark and its photograph.
struct AlbumEntry {
  std::int32_t landmark_id = 0;
  const Photograph* photograph = nullptr;
};

/// Location of a subject in an image.
struct Framing {
  vision::PixelRect frame;  ///< region to cut out, centred on the subject's axis
  vision::PixelRect trunk;  ///< region of its surface used for the sharpness
  double px_per_m = 0.0;
  double fraction = 1.0;   ///< fraction of the wanted frame inside the image, in (0, 1]
  bool is_hidden = false;  ///< partly hidden by a nearer object
};

/// Framings of all subjects of a scan in an image exposed `dt_s` after the scan, with `motion` of
/// base between. The frame is empty for subjects outside the image, too small, or with their axis
/// hidden by a nearer subject.
std::vector<Framing> frame_subjects(const std::vector<Subject>& subjects, const detection::Rig& rig,
                                    const detection::Motion& motion, double dt_s);

/// Quality of a framing: details per metre of the subject's surface (sharpness x pixels per metre),
/// reduced by over- and underexposure, cropping and occlusion. 0: unusable.
double quality(const Framing& framing, vision::PictureReader& picture);

/// The frame as a JPEG of at most kPhotoWidthMax_px columns; empty if the image cannot be decoded.
std::vector<std::uint8_t> cropped_jpeg(const Framing& framing, vision::PictureReader& picture);

/// derived: 240 columns of 0.8 m are 3 mm each, enough for bark and tags.
inline constexpr int kPhotoWidthMax_px = 240;

/// Selects the best photograph of each landmark; photographs belong to the nearest landmark.
/// Returned in order of id. Photographs beyond `max_bytes` are left out: first those of objects,
/// then those of least worth.
std::vector<AlbumEntry> choose_photographs(const std::vector<Landmark>& landmarks,
                                           const std::vector<PlacedPhotograph>& photographs,
                                           std::size_t max_bytes);

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
  using Picture = std::shared_ptr<const vision::Image>;
  /// Best view of one position in one passing. It is cut out of its image when the passing ends:
  /// while the robot approaches, each view is better than the one before.
  struct Passing {
    double x_m = 0.0, y_m = 0.0;  ///< in map, by the pose at that time
    std::int64_t last_utime = 0;
    Photograph best;
    Framing framing;
    Picture picture;  ///< null: best.jpeg is cut out already
  };
  static std::size_t num_bytes_of(const Passing& passing);
  void take_scans();
  void observe(const WaitingScan& scan, const Picture& image);
  std::size_t passing_at(double x_m, double y_m, std::int64_t utime);
  void cut_out(Passing& passing);
  void drop_worst_photographs();

  detection::Rig rig_;
  std::size_t max_bytes_;
  std::vector<WaitingScan> scans_;  ///< in order of arrival
  std::vector<Picture> pictures_;   ///< likewise
  std::vector<Passing> passings_;   ///< in order of their start
  std::size_t num_over_ = 0;        ///< number of passings at the front that have ended
  std::size_t num_bytes_ = 0;       ///< total of all photographs
  std::optional<std::int64_t> last_picture_utime_;
};

}  // namespace orchard::mapping
