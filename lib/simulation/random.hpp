// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <random>

namespace orchard::simulation {

/// Purpose of a random number. Every stream is independent of all others, so disabling a sensor
/// changes nothing in the others.
enum class Stream : std::uint64_t {
  kScene = 1,
  kAppearance,
  kTargets,
  kScan,
  kImage,
  kOdometryRun,
  kOdometry,
  kGnss,
  kPoseFix,
  kBench,
  kTilt,
  kPosts,
  kStakes,
  kTwins,
  kCrates,
  kGrass,
  kTwigs,
  kBranches,
  kPeople,
  kHedges,
  kCrowns,
  kReflectors,
  kLean,
  kStart,
  kCarry,
  kChange,
  kGnssJump = 29,
  kImu,
  kImuRun,
  kVehicles,
  kScanRear,
  kParkPath,
  kParkScene,
  kWheelBias,
  kSurface,
  kLoad,
  kGnssSky,
  kTerrain,
  kLowBranches,
  kImuAttitude,
};

/// Seeded random numbers, identical on every standard library.
class Random {
 public:
  /// The random numbers of message `index` of a stream.
  explicit Random(std::uint64_t seed, Stream stream = Stream::kBench, std::uint64_t index = 0);

  std::uint64_t bits() { return engine_(); }
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }  ///< [0, 1)
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  double normal();  ///< mean 0, standard deviation 1
  double normal(double mean, double sd) { return mean + sd * normal(); }

 private:
  std::mt19937_64 engine_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

/// Hashes a number to 64 well-mixed bits.
std::uint64_t mix_bits(std::uint64_t value);

/// Converts twice 64 well-mixed bits to a normal number of mean 0 and standard deviation 1.
double normal_of(std::uint64_t bits, std::uint64_t other_bits);

}  // namespace orchard::simulation
