// SPDX-License-Identifier: BSD-3-Clause
#include "device/velodyne/velodyne_packet.hpp"

#include <cstring>

#include "geometry/angles.hpp"

namespace orchard::device {
namespace {

using Packet = VelodynePacket;

// physical: the layout of a packet.
constexpr std::size_t kBlockBytes = 100;
constexpr std::size_t kShotsAt = 4;  // within a block, after flag and azimuth
constexpr std::size_t kShotBytes = 3;
constexpr std::size_t kStampAt = 1200;
constexpr std::size_t kReturnsAt = 1204;
constexpr std::size_t kProductAt = 1205;
constexpr unsigned kBlockFlag = 0xeeff;  // the bytes ff ee
constexpr unsigned kVlp16 = 0x22;
constexpr std::size_t kPositionBytes = 512;
constexpr std::uint32_t kHour_us = 3'600'000'000;

// physical: heads turn 300 to 1200 times a minute, 20 to 80 hundredths of a degree per block; more
// is let through, so that a motor may stray by a quarter.
constexpr int kMinAdvance_cdeg = 15;
constexpr int kMaxAdvance_cdeg = 100;

unsigned two_bytes(const std::uint8_t* at) { return at[0] | unsigned{at[1]} << 8; }

std::string name_of(unsigned product) {
  switch (product) {
    case 0x21:
      return "an HDL-32E";
    case 0x24:
      return "a Puck Hi-Res";
    case 0x28:
      return "a VLP-32C";
    case 0x31:
      return "a Velarray";
    case 0x63:
      return "a VLS-128";
    default:
      return "a scanner of unknown number " + std::to_string(product);
  }
}

}  // namespace

double vlp16_elevation_rad(std::size_t laser) {
  // physical: lasers of even number look down from -15 degrees in steps of 2, those of odd number
  // up from +1 degree.
  const double deg =
      laser % 2 == 0 ? -15.0 + static_cast<double>(laser) : static_cast<double>(laser);
  return deg * geometry::kPi / 180.0;
}

std::variant<Packet, std::string> Packet::parse(std::string_view bytes) {
  if (bytes.size() == kPositionBytes) {
    return "position packets, not data; give the scanner's data port (2368 as delivered), not that "
           "of its telemetry (8308)";
  }
  if (bytes.size() != kNumBytes) {
    return "datagrams of " + std::to_string(bytes.size()) +
           " bytes, where a VLP-16 sends 1206; check the port, and what else sends to it";
  }
  Packet packet;
  std::memcpy(packet.bytes_.data(), bytes.data(), kNumBytes);
  if (std::string fault = packet.find_fault(); !fault.empty()) return fault;
  return packet;
}

/// Reads and checks what is not a shot; the reason if something is wrong.
std::string Packet::find_fault() {
  for (std::size_t block = 0; block < kNumBlocks; ++block) {
    const std::uint8_t* at = bytes_.data() + kBlockBytes * block;
    if (two_bytes(at) != kBlockFlag) return "a block without its flag (ff ee)";
    if (two_bytes(at + 2) >= kTurn_cdeg) return "an azimuth of 360 degrees or more";
  }
  if (bytes_[kProductAt] != kVlp16) {
    return "packets of " + name_of(bytes_[kProductAt]) +
           ": its layers are not known here; only VLP-16 and Puck LITE are";
  }
  const unsigned returns = bytes_[kReturnsAt];
  if (returns < 0x37 || returns > 0x39) {
    return "an unknown return mode, " + std::to_string(returns);
  }
  returns_ = static_cast<Returns>(returns);
  stamp_us_ = two_bytes(bytes_.data() + kStampAt) |
              std::uint32_t{two_bytes(bytes_.data() + kStampAt + 2)} << 16;
  if (stamp_us_ >= kHour_us) return "a time stamp of an hour or more";
  for (std::size_t block = 0; returns_ == Returns::kDual && block < kNumBlocks; block += 2) {
    if (azimuth_of(block) != azimuth_of(block + 1)) return "two returns of unlike azimuths";
  }
  int sum_cdeg = 0, num = 0;
  for (std::size_t column = 1; column < num_columns(); ++column) {
    const int advance_cdeg =
        (azimuth_cdeg(column) - azimuth_cdeg(column - 1) + kTurn_cdeg) % kTurn_cdeg;
    if (advance_cdeg < kMinAdvance_cdeg || advance_cdeg > kMaxAdvance_cdeg) continue;
    sum_cdeg += advance_cdeg;
    ++num;
  }
  // One leap may be: from the end of a field of view to its begin.
  if (num + 2 < static_cast<int>(num_columns())) {
    return "azimuths that are not those of a head that turns 300 to 1200 times a minute";
  }
  rate_cdeg_per_us_ = sum_cdeg / (num * kBlock_us);
  return {};
}

int Packet::azimuth_of(std::size_t block) const {
  return static_cast<int>(two_bytes(bytes_.data() + kBlockBytes * block + 2));
}

Packet::Shot Packet::shot(std::size_t column, std::size_t firing, std::size_t laser) const {
  const std::uint8_t* at = bytes_.data() + kBlockBytes * block_of(column) + kShotsAt +
                           kShotBytes * (kNumLasers * firing + laser);
  return {static_cast<std::uint16_t>(two_bytes(at)), at[2]};
}

}  // namespace orchard::device
