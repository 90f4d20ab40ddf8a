// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include "bus/messages/channel.hpp"
#include "bus/messages/codec.hpp"

namespace orchard::bus {

enum class Level : std::int8_t { kOk = 0, kWaiting = 1, kWarning = 2, kError = 3 };

/// State of a process, sent on STATUS. utime is wall clock time.
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

/// Configuration of a process, sent on CONFIG.
struct ConfigNotice {
  std::int64_t utime = 0;
  std::int32_t seq = 0;
  std::int64_t hash = 0;
  std::string name;
  std::string version;
  std::string text;
};

/// Identifies a message in an ACK. In the ACK of a BEGIN it names a channel that the node reads.
struct OutputId {
  Channel channel = Channel::kScan;
  std::int32_t seq = 0;
  bool operator==(const OutputId& other) const {
    return channel == other.channel && seq == other.seq;
  }
  bool operator<(const OutputId& other) const {
    return std::tie(channel, seq) < std::tie(other.channel, other.seq);
  }
};

/// Number of participants in a lockstep replay (detector, pose, mapper, player), numbered as in
/// ack_t.
inline constexpr std::int8_t kNumInLockstep = 4;

/// Says in a lockstep replay what a participant sends in a round; sent on ACK.
struct Ack {
  std::int64_t utime = 0;              ///< of the BEGIN
  std::int32_t seq = 0;                ///< number of the round; 0 in the answer to BEGIN
  std::int8_t node = 0;                ///< ack_t.DETECTOR, POSE, MAPPER, PLAYER
  Channel channel = Channel::kReplay;  ///< always
  std::vector<OutputId> outputs;
};

/// Marks the begin or the end of a log in a lockstep replay; sent on REPLAY.
struct ReplayMark {
  std::int64_t utime = 0;
  std::int32_t seq = 0;  ///< BEGIN: 0. END: 1 + number of the node that flushes
  bool end = false;
};

std::vector<std::uint8_t> encode(const Status& status);
std::vector<std::uint8_t> encode(const ConfigNotice& notice);
std::vector<std::uint8_t> encode(const Ack& ack);
std::vector<std::uint8_t> encode(const ReplayMark& mark);

// Decode and validate the service types. As with bus::decode, invalid bytes never throw.
std::variant<Status, Rejection> decode_status(const void* data, std::size_t size);
std::variant<ConfigNotice, Rejection> decode_config(const void* data, std::size_t size);
std::variant<Ack, Rejection> decode_ack(const void* data, std::size_t size);
std::variant<ReplayMark, Rejection> decode_replay(const void* data, std::size_t size);

// The fields of the service types in wire order; see fields.hpp.

struct StatusFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.stamp(m.utime, m.seq);
    v.field("level", m.level, 0, 3);
    v.field("num_good", m.num_good, 0, INT64_MAX);
    v.field("num_bad", m.num_bad, 0, INT64_MAX);
    v.field("num_lost", m.num_lost, 0, INT64_MAX);
    v.field("num_late", m.num_late, 0, INT64_MAX);
    v.field("num_duplicate", m.num_duplicate, 0, INT64_MAX);
    v.field("num_published", m.num_published, 0, INT64_MAX);
    v.field("input_period_s", m.input_period_s, 0, kDurationMax_s);
    v.field("latency_mean_s", m.latency_mean_s, 0, kDurationMax_s);
    v.field("latency_max_s", m.latency_max_s, 0, kDurationMax_s);
    v.text("name", m.name);
    v.text("host", m.host);
    v.text("text", m.text);
  }
  static constexpr double kDurationMax_s = 1e300;  ///< any finite duration
};

struct ConfigNoticeFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.stamp(m.utime, m.seq);
    v.field("hash", m.hash, INT64_MIN, INT64_MAX);
    v.text("name", m.name);
    v.text("version", m.version);
    v.text("text", m.text);
  }
};

struct AckFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    constexpr int kChannelMax = static_cast<int>(kNumChannels) - 1;
    v.stamp(m.utime, m.seq);
    v.count("num_outputs", m.outputs);
    v.field("node", m.node, 0, kNumInLockstep - 1);
    v.field("channel", m.channel, 0, kChannelMax);
    v.column("output_channels", m.outputs, "num_outputs", &OutputId::channel, 0, kChannelMax);
    v.column("output_seqs", m.outputs, "num_outputs", &OutputId::seq, INT32_MIN, INT32_MAX);
  }
};

struct ReplayMarkFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.stamp(m.utime, m.seq);
    v.field("command", m.end, 0, 1);  // BEGIN, END
  }
};

inline StatusFields fields_of(const Status&) { return {}; }
inline ConfigNoticeFields fields_of(const ConfigNotice&) { return {}; }
inline AckFields fields_of(const Ack&) { return {}; }
inline ReplayMarkFields fields_of(const ReplayMark&) { return {}; }

}  // namespace orchard::bus
