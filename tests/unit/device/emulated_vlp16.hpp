// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace orchard::test {

/// A vertical cylinder from one height to another.
struct Cylinder {
  double x_m = 0.0, y_m = 0.0, radius_m = 0.05;
  double from_m = 0.0, to_m = 4.0;
  bool is_thin = false;  ///< leaves: part of the beam goes on
};

/// Level ground, grass on it, and cylinders; the scanner stands at the origin.
struct Orchard {
  double scanner_height_m = 1.0;
  double grass_m = 0.0;
  std::vector<Cylinder> cylinders;
};

/// A VLP-16 by its user manual (63-9243, chapter 9), written from it for the tests: what stands in
/// an orchard as data packets.
class EmulatedVlp16 {
 public:
  static constexpr double kPi = 3.14159265358979323846;
  static constexpr double kFiring_us = 55.296;
  static constexpr std::array<int, 16> kElevations_deg{-15, 1, -13, 3,  -11, 5,  -9, 7,
                                                       -7,  9, -5,  11, -3,  13, -1, 15};
  static constexpr std::uint8_t kStrongest = 0x37, kLast = 0x38, kDual = 0x39;

  Orchard orchard;
  double rate_rpm = 600.0;
  std::uint8_t returns = kStrongest;
  std::uint32_t start_us = 1'000'000;  ///< what its clock shows at time 0
  double azimuth_deg = 100.0;          ///< at time 0

  double packet_us() const { return kFiring_us * (returns == kDual ? 12 : 24); }

  double azimuth_at(double time_us) const { return azimuth_deg + rate_rpm * 6e-6 * time_us; }

  /// The payload of datagram `number`, which begins at number x packet_us().
  std::string packet(int number) const {
    std::string bytes;
    const double begin_us = packet_us() * number;
    for (int block = 0; block < 12; ++block) {
      const int pair = returns == kDual ? block / 2 : block;
      const double block_us = begin_us + 2 * kFiring_us * pair;
      put_two(bytes, 0xeeff);
      put_two(bytes, static_cast<unsigned>(std::lround(100.0 * azimuth_at(block_us))) % 36000);
      for (int shot = 0; shot < 32; ++shot) {
        const double shot_us = block_us + kFiring_us * (shot / 16) + 2.304 * (shot % 16);
        const bool is_last = returns == kLast || (returns == kDual && block % 2 == 0);
        put_shot(bytes, azimuth_at(shot_us), kElevations_deg[static_cast<std::size_t>(shot % 16)],
                 is_last);
      }
    }
    const auto stamp_us = static_cast<std::uint32_t>(
        static_cast<std::uint64_t>(start_us + std::llround(begin_us)) % 3'600'000'000u);
    put_two(bytes, stamp_us & 0xffffu);
    put_two(bytes, stamp_us >> 16);
    bytes += static_cast<char>(returns);
    bytes += '\x22';
    return bytes;
  }

  /// Distance along the horizontal from the origin to a cylinder on a bearing; infinite past it.
  static double level_range_m(const Cylinder& c, double bearing_rad) {
    const double along_m = c.x_m * std::cos(bearing_rad) + c.y_m * std::sin(bearing_rad);
    const double across_m = c.y_m * std::cos(bearing_rad) - c.x_m * std::sin(bearing_rad);
    const double half2 = c.radius_m * c.radius_m - across_m * across_m;
    if (along_m <= 0.0 || half2 < 0.0) return std::numeric_limits<double>::infinity();
    return along_m - std::sqrt(half2);
  }

 private:
  static void put_two(std::string& bytes, unsigned value) {
    bytes += static_cast<char>(value & 0xffu);
    bytes += static_cast<char>(value >> 8 & 0xffu);
  }

  void put_shot(std::string& bytes, double azimuth, int elevation_deg, bool is_last) const {
    const double bearing_rad = -azimuth * kPi / 180.0;
    const double slope = std::tan(elevation_deg * kPi / 180.0);
    double nearest_m = std::numeric_limits<double>::infinity();
    unsigned reflectivity = 0;
    if (slope < 0.0) {
      nearest_m = (orchard.grass_m - orchard.scanner_height_m) / slope;
      reflectivity = 40;
    }
    for (const Cylinder& c : orchard.cylinders) {
      const double level_m = level_range_m(c, bearing_rad);
      const double height_m = orchard.scanner_height_m + level_m * slope;
      if (level_m >= nearest_m || height_m < c.from_m || height_m > c.to_m) continue;
      if (c.is_thin && is_last) continue;
      nearest_m = level_m;
      reflectivity = c.is_thin ? 90 : 20;
    }
    const double range_m = nearest_m * std::sqrt(1.0 + slope * slope);
    const bool returns_it = range_m < 100.0;
    put_two(bytes, returns_it ? static_cast<unsigned>(std::lround(range_m / 0.002)) : 0u);
    bytes += static_cast<char>(returns_it ? reflectivity : 0u);
  }
};

}  // namespace orchard::test
