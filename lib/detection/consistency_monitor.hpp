// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "detection/consistency_config.hpp"

namespace orchard::detection {

/// Largest disagreement of laser and image edges that is looked for [deg].
inline constexpr double kSearchWindow_deg = 4.0;

/// Watches how far the edges that pictures show stand from where the laser expects them, and says
/// so when the running median disagrees for long. Time is the messages' own.
///
/// The median is signed: it finds a camera turned about its vertical axis, and a delay while the
/// robot turns one way. A delay alone cancels out over curves to both sides; it is measured by
/// `orchard calibrate delay`. Disagreements beyond kSearchWindow_deg are not seen at all.
class ConsistencyMonitor {
 public:
  /// `focal_px`: the camera's focal length across the columns, for degrees.
  ConsistencyMonitor(const ConsistencyConfig& config, double focal_px);

  /// Whether it is time to look at a picture's edges again.
  bool is_due(std::int64_t utime) const;

  /// Takes what was found at a time [us], not before the last one: found minus expected column of
  /// each object's middle [px]. Empty when the picture showed none.
  void add(std::int64_t utime, const std::vector<double>& offsets_px);

  /// The running median [px]; 0 while there are too few observations in too little time.
  double median_px() const { return median_px_; }
  int num_observations() const { return static_cast<int>(observations_.size()); }
  bool is_raised() const { return raised_; }

  /// The disagreement now as a sentence for a person; empty when all is well.
  std::string warning() const;
  /// The largest disagreement of the whole run, when it was ever raised; empty otherwise.
  std::string whole_run() const;

 private:
  struct Observation {
    std::int64_t utime;
    double offset_px;
  };
  double degrees(double offset_px) const;
  std::string disagreement(const char* verb, double offset_px, double duration_s) const;

  ConsistencyConfig config_;
  double focal_px_;
  std::deque<Observation> observations_;
  std::int64_t first_utime_ = INT64_MIN;
  std::int64_t last_utime_ = INT64_MIN;
  double median_px_ = 0.0;
  bool raised_ = false;
  std::int64_t raised_us_ = 0;  ///< of the whole run
  double worst_px_ = 0.0;       ///< while raised
};

}  // namespace orchard::detection
