// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <memory>

#include "io/config/config.hpp"
#include "laser/scan.hpp"
#include "mapping/existence/free_space.hpp"

namespace orchard::procs {

/// The looks of SCAN's beams that wait for their DETECTIONS, one per mapper.existence.period_s, and
/// whether DETECTIONS are to wait for their SCAN.
///
/// DETECTIONS(t) wait for a SCAN at or after t, so that the order in which the two arrive does not
/// matter. Where none has come within mapper.existence.scan_wait_s of message time, nobody waits
/// until SCAN is heard (again): a mapper that is given none works without.
class LookQueue {
 public:
  explicit LookQueue(const io::Config& config);

  /// Whether SCAN is of any use.
  bool wanted() const { return wait_us_ > 0; }

  void add(const laser::Scan& scan);

  /// Whether DETECTIONS of that time need not wait any longer; `newest_utime` is message time.
  bool is_ready(std::int64_t utime, std::int64_t newest_utime) const;

  /// The look of exactly that time, or none; older ones are forgotten. Notes when SCAN is missing.
  std::shared_ptr<mapping::BeamLook> take(std::int64_t utime);

  /// Whether DETECTIONS were used whose SCAN had not come, and none has come since.
  bool is_missing() const { return is_missing_; }

 private:
  laser::LaserConfig laser_;
  laser::BlindSector blind_;
  std::int64_t period_us_;
  std::int64_t wait_us_;
  std::deque<std::shared_ptr<mapping::BeamLook>> looks_;  ///< in order of utime
  std::int64_t newest_utime_ = 0;                         ///< of SCAN
  std::int64_t last_kept_utime_ = 0;
  bool has_any_ = false;
  bool is_missing_ = false;
};

}  // namespace orchard::procs
