// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bus/messages/service_messages.hpp"

namespace orchard::cli {

/// The last known status of a process.
struct ProcessView {
  bus::Status status;
  double age_s = 0.0;             ///< since its last STATUS
  double input_hz = 0.0;          ///< 0 without input
  double clock_offset_s = 0.0;    ///< clock of its host minus ours
  std::int64_t num_new_lost = 0;  ///< messages lost since the STATUS before
};

/// Collects the status of all processes of all hosts from STATUS. Pure: times are arguments.
class StatusBoard {
 public:
  /// Adds a STATUS. `receipt_utime`: our clock at its arrival [us].
  void note(const bus::Status& status, std::int64_t receipt_utime);

  /// The processes in order of host and name, without those silent for a minute.
  std::vector<ProcessView> processes(std::int64_t now_utime) const;

 private:
  struct Entry {
    bus::Status last;
    std::int64_t receipt_utime = 0;
    std::int64_t num_new_lost = 0;
    std::vector<std::int64_t> offsets_us;  ///< STATUS utime minus receipt time, of the last few
  };
  void forget_earlier(const bus::Status& status, std::int64_t receipt_utime);

  std::map<std::pair<std::string, std::string>, Entry> entries_;
};

/// Min silence of a process that one late STATUS cannot explain [s].
constexpr double kSilent_s = 2.5;

/// Max acceptable difference between the clocks of two hosts [s]: at 1 m/s it displaces
/// observations by 2 cm.
constexpr double kClockOffsetMax_s = 0.02;

}  // namespace orchard::cli
