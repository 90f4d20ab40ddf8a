// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bus/messages/service_messages.hpp"

namespace orchard::bus {

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
    v.field("node", m.node, 0, kNumLockstepNodes - 1);
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
