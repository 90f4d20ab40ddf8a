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

/// What is wrong with the scans and pictures that a detector is given, in words for a person: no
/// picture comes, none can be used, ODOMETRY is missing, scans show the robot itself. Changes no
/// output.
class InputHealth {
 public:
  explicit InputHealth(const io::Config& config);

  void note_scan(const laser::Scan& scan) { own_returns_.add(scan); }
  void note_rear_scan(const laser::Scan& scan) { rear_own_returns_.add(scan); }
  /// A scan was answered without a picture.
  void note_no_picture();
  /// A scan was answered with this picture; `without_motion`: motion was asked for, and none came.
  void note_picture(bool without_motion);
  /// What the picture was needed for could be looked at, or not.
  void note_looked_at(const vision::Image& image, bool is_usable);

  /// What is wrong now; at the end what was. `num_without_motion`: pictures so far.
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
  std::int64_t num_pictures_ = 0;         ///< that belonged to a scan
  std::int64_t num_without_picture_ = 0;  ///< scans that none belonged to
  std::int64_t num_since_picture_ = 0;    ///< of those, since the last that had one
  bool last_without_motion_ = false;      ///< the newest of them, where motion was asked for
  std::int64_t num_usable_ = 0;           ///< of those that were needed
  std::int64_t num_unusable_ = 0;
  std::int64_t num_since_usable_ = 0;
  std::int32_t bad_width_px_ = 0;  ///< of the newest that was not usable
  std::int32_t bad_height_px_ = 0;
};

}  // namespace orchard::procs
