// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/scan_to_map.hpp"

#include <algorithm>
#include <cstring>

#include "benchmark/relay.hpp"

namespace orchard::bench {
namespace {

using bus::Channel;

std::string name_of(Channel channel) { return std::string(bus::info(channel).name); }

std::vector<const RawMessage*> messages_of(const FieldDrive& drive, Channel channel) {
  std::vector<const RawMessage*> messages;
  for (const RawMessage& message : drive.messages) {
    if (message.channel == channel) messages.push_back(&message);
  }
  return messages;
}

}  // namespace

std::vector<ScanSet> scan_sets(const FieldDrive& drive) {
  const auto scans = messages_of(drive, Channel::kScan);
  const auto images = messages_of(drive, Channel::kImage);
  std::vector<ScanSet> sets;
  std::int64_t sent_until = INT64_MIN;
  for (std::size_t i = 0; i + 1 < scans.size(); ++i) {
    const std::int64_t utime = scans[i]->utime, next_utime = scans[i + 1]->utime;
    const auto image = std::find_if(images.begin(), images.end(), [utime](const auto* message) {
      return message->utime == utime;
    });
    if (image == images.end()) continue;
    ScanSet set;
    set.utime = utime;
    set.inputs.push_back(scans[i]);
    for (const Channel channel : {Channel::kOdometry, Channel::kPoseFix}) {
      for (const RawMessage* message : messages_of(drive, channel)) {
        if (message->utime > sent_until && message->utime <= next_utime) {
          set.inputs.push_back(message);
        }
      }
      if (channel == Channel::kOdometry) {
        set.num_detector_inputs = static_cast<std::uint32_t>(set.inputs.size()) + 1;
      }
    }
    set.inputs.push_back(*image);
    sent_until = next_utime;
    sets.push_back(std::move(set));
  }
  return sets;
}

MapProbe::MapProbe(const std::string& url, bool relayed) : lcm_(url), relayed_(relayed) {
  lcm_.subscribe(name_of(Channel::kMap), &MapProbe::on_map, this);
}

void MapProbe::send(Channel channel, const std::vector<std::uint8_t>& bytes) {
  if (channel == Channel::kImage) sent_ = Clock::now();
  lcm_.publish(name_of(channel), bytes.data(), static_cast<unsigned int>(bytes.size()));
}

double MapProbe::wait_for_map(std::int64_t utime, Clock::time_point until) {
  utime_ = 0;
  while (utime_ != utime) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now());
    if (left.count() <= 0) return -1.0;
    lcm_.handleTimeout(static_cast<int>(left.count()));
  }
  return std::chrono::duration<double, std::milli>(received_ - sent_).count();
}

double MapProbe::through(const ScanSet& set, Clock::time_point until) {
  for (const RawMessage* input : set.inputs) send(input->channel, input->bytes);
  return wait_for_map(set.utime, until);
}

void MapProbe::on_map(const lcm::ReceiveBuffer* buffer, const std::string&) {
  received_ = Clock::now();
  const auto* bytes = static_cast<const std::uint8_t*>(buffer->data);
  RelayHeader header;
  if (buffer->data_size < sizeof header) return;
  std::memcpy(&header, bytes, sizeof header);
  // An LCM type begins with its hash; then comes utime, big-endian.
  std::int64_t utime = 0;
  for (int i = 8; i < 16; ++i) utime = utime << 8 | bytes[i];
  utime_ = relayed_ ? header.utime : utime;
}

}  // namespace orchard::bench
