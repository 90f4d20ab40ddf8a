// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bus/messages/service_messages.hpp"

namespace orchard::cli {

/// One process as it was heard of last.
struct ProcessView {
  bus::Status status;
  double age_s = 0.0;             ///< since its last STATUS
  double input_hz = 0.0;          ///< 0 without input
  double clock_offset_s = 0.0;    ///< its host's clock over ours; positive: ahead
  std::int64_t num_new_lost = 0;  ///< since the STATUS before
};

/// Every process of every host, by what their STATUS said. Pure: times are given.
class StatusBoard {
 public:
  /// `receipt_utime`: our time of day when it came [us].
  void note(const bus::Status& status, std::int64_t receipt_utime);

  /// In order of host and name, without those not heard of for a minute.
  std::vector<ProcessView> processes(std::int64_t now_utime) const;

 private:
  struct Entry {
    bus::Status last;
    std::int64_t receipt_utime = 0;
    std::int64_t num_new_lost = 0;
    std::vector<std::int64_t> offsets_us;  ///< STATUS utime less receipt, of the last few
  };
  void forget_earlier(const bus::Status& status, std::int64_t receipt_utime);

  std::map<std::pair<std::string, std::string>, Entry> entries_;
};

/// Silence of a process that is more than one late STATUS [s].
constexpr double kSilent_s = 2.5;

/// A difference between the clocks of two hosts that measurements would feel [s]: at 1 m/s it moves
/// what was seen by 2 cm.
constexpr double kClockOffsetMax_s = 0.02;

}  // namespace orchard::cli
