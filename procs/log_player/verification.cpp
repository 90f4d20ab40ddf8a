// SPDX-License-Identifier: BSD-3-Clause
#include "log_player/verification.hpp"

#include <algorithm>

#include "io/file_error.hpp"

namespace orchard::procs {
namespace {

std::string name_of(std::size_t channel) { return std::string(bus::kChannels[channel].name); }

/// All types have utime and seq first, after the 8-byte hash of the type.
std::int32_t seq_at(const std::vector<std::uint8_t>& bytes) {
  if (bytes.size() < 20) return -1;
  std::uint32_t seq = 0;
  for (std::size_t i = 16; i < 20; ++i) seq = seq << 8 | bytes[i];
  return static_cast<std::int32_t>(seq);
}

std::int64_t utime_at(const std::vector<std::uint8_t>& bytes) {
  if (bytes.size() < 16) return -1;
  std::uint64_t utime = 0;
  for (std::size_t i = 8; i < 16; ++i) utime = utime << 8 | bytes[i];
  return static_cast<std::int64_t>(utime);
}

}  // namespace

Verification::Verification(const std::string& log_path) : reader_(log_path) {
  bool any = false;
  while (const auto event = reader_.next()) {
    const auto channel = bus::find_channel(event->channel);
    if (!channel || bus::info(*channel).role != bus::Role::kDerived) continue;
    any = true;
    // A damaged seq is recorded, too: it will count as missing or as an extra message.
    states_[static_cast<std::size_t>(*channel)].recorded.emplace(seq_at(event->data),
                                                                 event->offset);
  }
  if (!any) {
    throw io::FileError(log_path + ": has no derived message (POSE, DETECTIONS, MAP) to verify");
  }
}

void Verification::take(bus::Channel channel, const std::vector<std::uint8_t>& bytes) {
  State& state = states_[static_cast<std::size_t>(channel)];
  ++state.num_taken;
  if (state.recorded.empty() && state.num_equal == 0 && state.num_different == 0) {
    ++state.num_tail;
    return;
  }
  const std::int32_t seq = seq_at(bytes);
  const std::string where = name_of(static_cast<std::size_t>(channel)) + " seq " +
                            std::to_string(seq) + " utime " + std::to_string(utime_at(bytes));
  const auto found = state.recorded.find(seq);
  if (found == state.recorded.end()) {
    const bool is_tail = state.recorded.empty() || seq > state.recorded.rbegin()->first;
    if (is_tail) {
      ++state.num_tail;
    } else {
      differ(state, where + ": not in the log");
    }
    return;
  }
  const std::vector<std::uint8_t> recorded = reader_.read_at(found->second).data;
  state.recorded.erase(found);
  if (recorded == bytes) {
    ++state.num_equal;
    return;
  }
  const std::size_t common = std::min(recorded.size(), bytes.size());
  const auto first = std::mismatch(
      bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(common), recorded.begin());
  differ(state, where + ": differs at byte " + std::to_string(first.first - bytes.begin()) + " (" +
                    std::to_string(recorded.size()) + " bytes recorded, " +
                    std::to_string(bytes.size()) + " now)");
}

void Verification::finish() {
  for (std::size_t i = 0; i < states_.size(); ++i) {
    State& state = states_[i];
    for (const auto& [seq, offset] : state.recorded) {
      differ(state, name_of(i) + " seq " + std::to_string(seq) + " (offset " +
                        std::to_string(offset) + " in the log): recorded, but not reproduced");
    }
  }
}

void Verification::differ(State& state, std::string text) {
  if (state.num_different++ == 0) state.first_difference = std::move(text);
  ++num_different_;
}

std::vector<std::string> Verification::describe() const {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const State& state = states_[i];
    if (state.num_taken == 0 && state.num_different == 0) continue;
    if (state.num_different > 0) {
      lines.push_back("first difference: " + state.first_difference);
    }
    lines.push_back(name_of(i) + ": " + std::to_string(state.num_equal) + " equal, " +
                    std::to_string(state.num_different) + " different");
    if (state.num_tail > 0) {
      lines.push_back("note: " + name_of(i) + ": " + std::to_string(state.num_tail) +
                      " messages at the end of the replay are not in the log (its recording "
                      "stopped before the processes flushed)");
    }
  }
  return lines;
}

}  // namespace orchard::procs
