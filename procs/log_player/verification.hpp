// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "bus/messages/channel.hpp"
#include "io/log/log_reader.hpp"

namespace orchard::procs {

/// Compares newly derived messages byte by byte with the recorded ones of a log.
///
/// A recording that was stopped before the nodes flushed lacks the last messages: this is noted,
/// but is not a difference. Other bytes, a message missing in between, and a recorded message that
/// was not made again are differences.
class Verification {
 public:
  /// Throws io::FileError when the log holds no derived message to compare with.
  explicit Verification(const std::string& log_path);

  /// Adds the next newly derived message of a channel, in order of seq.
  void take(bus::Channel channel, const std::vector<std::uint8_t>& bytes);

  /// Call after the last message: counts recorded messages that were not made again.
  void finish();

  bool equal() const { return num_different_ == 0; }

  /// Sentences for the user: the first difference of each channel, notes, and the number of equal
  /// messages.
  std::vector<std::string> describe() const;

 private:
  struct State {
    std::map<std::int32_t, std::uint64_t> recorded;  ///< seq to offset in the log
    std::int64_t num_equal = 0;
    std::int64_t num_tail = 0;  ///< derived messages after the end of the recording
    std::int64_t num_different = 0;
    std::int64_t num_taken = 0;
    std::string first_difference;
  };
  void differ(State& state, std::string text);

  io::LogReader reader_;
  std::array<State, bus::kNumChannels> states_;
  std::int64_t num_different_ = 0;
};

}  // namespace orchard::procs
