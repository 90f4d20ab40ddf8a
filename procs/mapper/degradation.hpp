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

/// Stretches of a drive in which something that the rig has did not come, while the mapper went on
/// without it, and which landmarks were first seen then.
///
/// Everything is a function of message times, in whatever order the channels came.
class Degradation {
 public:
  /// `has_camera`: DETECTIONS without a picture are less than usual.
  explicit Degradation(bool has_camera) : has_camera_(has_camera) {}

  /// A scan was used; `image_utime` 0: without a picture. `last_id`: the highest so far.
  void note_scan(std::int64_t utime, std::int64_t image_utime, std::int32_t last_id);
  /// A usable fix came.
  void note_fix(std::int64_t utime);

  /// All stretches so far, in order of time; of a rig that never had a fix none for GNSS.
  std::vector<io::DegradedInterval> intervals() const;

  /// Whether the last scan stands in a stretch without pictures.
  bool lacks_pictures_now() const { return has_camera_ && !pictures_.empty() && is_open_; }

  /// What it comes to, in words for a person; empty for none.
  std::string text() const;

  template <class Archive>
  void persist(Archive& archive) {
    archive(first_utime_, last_utime_, last_picture_utime_, is_open_, pictures_, first_fix_utime_,
            last_fix_utime_, fixes_, ids_);
  }

 private:
  using Span = std::pair<std::int64_t, std::int64_t>;
  std::int32_t id_at(std::int64_t utime) const;
  bool has_scan_between(std::int64_t after_utime, std::int64_t before_utime) const;

  bool has_camera_;
  std::optional<std::int64_t> first_utime_;
  std::int64_t last_utime_ = 0;
  std::optional<std::int64_t> last_picture_utime_;  ///< of the last scan that had one
  bool is_open_ = false;                            ///< the last of pictures_ goes on
  std::vector<Span> pictures_;                      ///< without
  std::optional<std::int64_t> first_fix_utime_, last_fix_utime_;
  std::vector<Span> fixes_;                                 ///< between two
  std::vector<std::pair<std::int64_t, std::int32_t>> ids_;  ///< the highest, about once a second
};

}  // namespace orchard::procs
