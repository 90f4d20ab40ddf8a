// SPDX-License-Identifier: BSD-3-Clause
#include "bus/messages/service_messages.hpp"

#include <cmath>
#include <exception>
#include <optional>
#include <utility>

#include "bus/messages/validity.hpp"
#include "bus/messages/wire_layout.hpp"
#include "bus/messages/wire_types.hpp"
#include "orchard/ack_t.hpp"
#include "orchard/config_t.hpp"
#include "orchard/replay_t.hpp"
#include "orchard/status_t.hpp"

namespace orchard::bus {
namespace {

/// Layout check and generated decoder; `out` is filled when none is returned.
template <class Wire>
std::optional<Rejection> decode_into(Channel channel, const void* data, std::size_t size,
                                     Wire& out) {
  if (std::optional<Rejection> rejection = check_layout(channel, data, size)) return rejection;
  try {
    if (out.decode(data, 0, static_cast<int>(size)) != static_cast<int>(size)) {
      return Rejection{Reason::kUndecodable, "the decoder left bytes over"};
    }
  } catch (const std::exception& error) {
    return Rejection{Reason::kUndecodable, error.what()};
  }
  if (out.utime < 0 || out.utime >= kUtimeEnd) {
    return Rejection{Reason::kOutOfRange, "utime = " + std::to_string(out.utime)};
  }
  if (out.seq < 0) return Rejection{Reason::kOutOfRange, "seq = " + std::to_string(out.seq)};
  return std::nullopt;
}

Rejection out_of_range(const char* name, std::int64_t value) {
  return {Reason::kOutOfRange, std::string(name) + " = " + std::to_string(value)};
}

}  // namespace

std::vector<std::uint8_t> encode(const Status& status) {
  status_t wire{};
  wire.utime = status.utime;
  wire.seq = status.seq;
  wire.level = static_cast<std::int8_t>(status.level);
  wire.num_good = status.num_good;
  wire.num_bad = status.num_bad;
  wire.num_lost = status.num_lost;
  wire.num_late = status.num_late;
  wire.num_duplicate = status.num_duplicate;
  wire.num_published = status.num_published;
  wire.input_period_s = status.input_period_s;
  wire.latency_mean_s = status.latency_mean_s;
  wire.latency_max_s = status.latency_max_s;
  wire.name = status.name;
  wire.host = status.host;
  wire.text = status.text;
  return encode_wire(wire);
}

std::variant<Status, Rejection> decode_status(const void* data, std::size_t size) {
  status_t wire{};
  if (auto rejection = decode_into(Channel::kStatus, data, size, wire)) return *rejection;
  if (wire.level < 0 || wire.level > 3) return out_of_range("level", wire.level);
  for (const double value : {wire.input_period_s, wire.latency_mean_s, wire.latency_max_s}) {
    if (!std::isfinite(value)) return Rejection{Reason::kNotFinite, "a period or latency"};
    if (value < 0) return Rejection{Reason::kOutOfRange, "a negative period or latency"};
  }
  for (const std::int64_t count : {wire.num_good, wire.num_bad, wire.num_lost, wire.num_late,
                                   wire.num_duplicate, wire.num_published}) {
    if (count < 0) return out_of_range("count", count);
  }
  Status status;
  status.utime = wire.utime;
  status.seq = wire.seq;
  status.level = static_cast<Level>(wire.level);
  status.num_good = wire.num_good;
  status.num_bad = wire.num_bad;
  status.num_lost = wire.num_lost;
  status.num_late = wire.num_late;
  status.num_duplicate = wire.num_duplicate;
  status.num_published = wire.num_published;
  status.input_period_s = wire.input_period_s;
  status.latency_mean_s = wire.latency_mean_s;
  status.latency_max_s = wire.latency_max_s;
  status.name = std::move(wire.name);
  status.host = std::move(wire.host);
  status.text = std::move(wire.text);
  return status;
}

std::vector<std::uint8_t> encode(const ConfigNotice& notice) {
  config_t wire{};
  wire.utime = notice.utime;
  wire.seq = notice.seq;
  wire.hash = notice.hash;
  wire.name = notice.name;
  wire.version = notice.version;
  wire.text = notice.text;
  return encode_wire(wire);
}

std::variant<ConfigNotice, Rejection> decode_config(const void* data, std::size_t size) {
  config_t wire{};
  if (auto rejection = decode_into(Channel::kConfig, data, size, wire)) return *rejection;
  return ConfigNotice{
      wire.utime,          wire.seq, wire.hash, std::move(wire.name), std::move(wire.version),
      std::move(wire.text)};
}

std::vector<std::uint8_t> encode(const Ack& ack) {
  ack_t wire{};
  wire.utime = ack.utime;
  wire.seq = ack.seq;
  wire.num_outputs = static_cast<std::int32_t>(ack.outputs.size());
  wire.node = ack.node;
  wire.channel = static_cast<std::int8_t>(ack.channel);
  for (const OutputId& output : ack.outputs) {
    wire.output_channels.push_back(static_cast<std::int8_t>(output.channel));
    wire.output_seqs.push_back(output.seq);
  }
  return encode_wire(wire);
}

std::variant<Ack, Rejection> decode_ack(const void* data, std::size_t size) {
  ack_t wire{};
  if (auto rejection = decode_into(Channel::kAck, data, size, wire)) return *rejection;
  constexpr auto kEnd = static_cast<std::int8_t>(kNumChannels);
  if (wire.node < 0 || wire.node > ack_t::MAPPER) return out_of_range("node", wire.node);
  if (wire.channel < 0 || wire.channel >= kEnd) return out_of_range("channel", wire.channel);
  Ack ack;
  ack.utime = wire.utime;
  ack.seq = wire.seq;
  ack.node = wire.node;
  ack.channel = static_cast<Channel>(wire.channel);
  for (std::size_t i = 0; i < wire.output_channels.size(); ++i) {
    const std::int8_t channel = wire.output_channels[i];
    if (channel < 0 || channel >= kEnd) return out_of_range("output_channels", channel);
    ack.outputs.push_back({static_cast<Channel>(channel), wire.output_seqs[i]});
  }
  return ack;
}

std::vector<std::uint8_t> encode(const ReplayMark& mark) {
  replay_t wire{};
  wire.utime = mark.utime;
  wire.seq = mark.seq;
  wire.command = mark.end ? replay_t::END : replay_t::BEGIN;
  return encode_wire(wire);
}

std::variant<ReplayMark, Rejection> decode_replay(const void* data, std::size_t size) {
  replay_t wire{};
  if (auto rejection = decode_into(Channel::kReplay, data, size, wire)) return *rejection;
  if (wire.command != replay_t::BEGIN && wire.command != replay_t::END) {
    return out_of_range("command", wire.command);
  }
  return ReplayMark{wire.utime, wire.seq, wire.command == replay_t::END};
}

}  // namespace orchard::bus
