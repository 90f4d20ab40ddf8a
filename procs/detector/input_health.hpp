// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "io/config/config.hpp"
#include "laser/own_returns.hpp"
#include "laser/scan.hpp"
#include "vision/image.hpp"

namespace orchard::procs {

/// Diagnoses a detector's inputs as text for the user: no picture arrives, none is usable, ODOMETRY
/// is missing, scans show the robot itself. Changes no output.
class InputHealth {
 public:
  explicit InputHealth(const io::Config& config);

  void note_scan(const laser::Scan& scan) { own_returns_.add(scan); }
  void note_rear_scan(const laser::Scan& scan) { rear_own_returns_.add(scan); }
  /// Notes a scan that was answered without a picture.
  void note_no_picture();
  /// Notes a scan that was answered with a picture. `without_motion`: motion was required and none
  /// was available.
  void note_picture(bool without_motion);
  /// Notes whether a picture that was needed was usable.
  void note_needed_picture(const vision::Image& image, bool is_usable);

  /// The current faults; with `ended` those of the whole run. `num_without_motion`: pictures used
  /// without motion so far.
  std::string text(bool ended, std::int64_t num_without_motion) const;

 private:
  std::string picture_text(bool ended) const;
  std::string unusable_text(bool ended) const;
  std::string odometry_text(bool ended, std::int64_t num_without_motion) const;

  bool has_camera_;
  std::int32_t width_px_;
  std::int32_t height_px_;
  laser::OwnReturns own_returns_;
  laser::OwnReturns rear_own_returns_;
  std::int64_t num_pictures_ = 0;         ///< pictures paired with a scan
  std::int64_t num_without_picture_ = 0;  ///< scans without a picture
  std::int64_t num_since_picture_ = 0;    ///< scans without a picture since the last one with
  bool last_without_motion_ = false;      ///< the newest pair had no motion, although required
  std::int64_t num_usable_ = 0;           ///< usable ones among the needed pictures
  std::int64_t num_unusable_ = 0;
  std::int64_t num_since_usable_ = 0;
  std::int32_t bad_width_px_ = 0;  ///< size of the newest unusable picture
  std::int32_t bad_height_px_ = 0;
};

}  // namespace orchard::procs
