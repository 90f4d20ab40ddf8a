// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/map/map_folder.hpp"

namespace orchard::procs {

/// Intervals of a drive in which an expected input was missing while the mapper continued without
/// it, and the landmarks first seen in them.
///
/// Depends on message times only, not on the order in which the channels arrive.
class Degradation {
 public:
  /// `has_camera`: DETECTIONS without a picture count as degraded.
  explicit Degradation(bool has_camera) : has_camera_(has_camera) {}

  /// Adds a mapped scan; `image_utime` 0: without a picture. `last_id`: the highest landmark id so
  /// far.
  void note_scan(std::int64_t utime, std::int64_t image_utime, std::int32_t last_id);
  /// Adds a usable GNSS fix.
  void note_fix(std::int64_t utime);

  /// All intervals so far, in order of time; none for GNSS if the rig never had a fix.
  std::vector<io::DegradedInterval> intervals() const;

  /// True if the last scan is in an interval without pictures.
  bool lacks_pictures_now() const { return has_camera_ && !pictures_.empty() && is_open_; }

  /// The finding as text for the user; empty if there is none.
  std::string text() const;

 private:
  using Span = std::pair<std::int64_t, std::int64_t>;
  std::int32_t id_at(std::int64_t utime) const;
  bool has_scan_between(std::int64_t after_utime, std::int64_t before_utime) const;

  bool has_camera_;
  std::optional<std::int64_t> first_utime_;
  std::int64_t last_utime_ = 0;
  std::optional<std::int64_t> last_picture_utime_;  ///< of the last scan with a picture
  bool is_open_ = false;                            ///< the last of pictures_ has not ended
  std::vector<Span> pictures_;                      ///< intervals without pictures
  std::optional<std::int64_t> first_fix_utime_, last_fix_utime_;
  std::vector<Span> fixes_;                                 ///< intervals between two fixes
  std::vector<std::pair<std::int64_t, std::int32_t>> ids_;  ///< highest id by time, once a second
};

}  // namespace orchard::procs
