// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "bus/messages/channel.hpp"
#include "bus/messages/codec.hpp"

namespace orchard::bus {

enum class Level : std::int8_t { kOk = 0, kWaiting = 1, kWarning = 2, kError = 3 };

/// How a process is: STATUS. Times are wall clock.
struct Status {
  std::int64_t utime = 0;
  std::int32_t seq = 0;
  Level level = Level::kOk;
  std::int64_t num_good = 0;
  std::int64_t num_bad = 0;
  std::int64_t num_lost = 0;
  std::int64_t num_late = 0;
  std::int64_t num_duplicate = 0;
  std::int64_t num_published = 0;
  double input_period_s = 0.0;
  double latency_mean_s = 0.0;
  double latency_max_s = 0.0;
  std::string name;
  std::string host;
  std::string text;
};

/// What a process runs with: CONFIG.
struct ConfigNotice {
  std::int64_t utime = 0;
  std::int32_t seq = 0;
  std::int64_t hash = 0;
  std::string name;
  std::string version;
  std::string text;
};

/// An output that followed from an input. In the ACK of a BEGIN: a channel the node consumes.
struct OutputId {
  Channel channel = Channel::kScan;
  std::int32_t seq = 0;
};

/// Nodes that take part in a lockstep replay: detector, pose, mapper, numbered as in ack_t.
inline constexpr std::int8_t kNumLockstepNodes = 3;

/// Lockstep: a node has consumed an input and published what follows from it. ACK.
struct Ack {
  std::int64_t utime = 0;            ///< of the input
  std::int32_t seq = 0;              ///< of the input
  std::int8_t node = 0;              ///< ack_t.DETECTOR, POSE, MAPPER
  Channel channel = Channel::kScan;  ///< of the input
  std::vector<OutputId> outputs;
};

/// Lockstep: a log begins or ends. REPLAY.
struct ReplayMark {
  std::int64_t utime = 0;
  std::int32_t seq = 0;  ///< BEGIN: 0. END: 1 + the number of the node that is to flush
  bool end = false;
};

std::vector<std::uint8_t> encode(const Status& status);
std::vector<std::uint8_t> encode(const ConfigNotice& notice);
std::vector<std::uint8_t> encode(const Ack& ack);
std::vector<std::uint8_t> encode(const ReplayMark& mark);

// The guarded decode of the service types; as bus::decode, they never throw on account of the
// bytes.
std::variant<Status, Rejection> decode_status(const void* data, std::size_t size);
std::variant<ConfigNotice, Rejection> decode_config(const void* data, std::size_t size);
std::variant<Ack, Rejection> decode_ack(const void* data, std::size_t size);
std::variant<ReplayMark, Rejection> decode_replay(const void* data, std::size_t size);

}  // namespace orchard::bus
