// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/random.hpp"

#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::simulation {

std::uint64_t mix_bits(std::uint64_t value) {
  // the finalizer of SplitMix64 (Steele, Lea, Flood 2014)
  value += 0x9e3779b97f4a7c15ull;
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9ull;
  value = (value ^ (value >> 27)) * 0x94d049bb133111ebull;
  return value ^ (value >> 31);
}

Random::Random(std::uint64_t seed, Stream stream, std::uint64_t index)
    : engine_(mix_bits(mix_bits(mix_bits(seed) ^ static_cast<std::uint64_t>(stream)) ^ index)) {}

double normal_of(std::uint64_t bits, std::uint64_t other_bits) {
  const auto uniform = [](std::uint64_t b) { return static_cast<double>(b >> 11) * 0x1.0p-53; };
  return std::sqrt(-2.0 * std::log(1.0 - uniform(bits))) *
         std::cos(2.0 * geometry::kPi * uniform(other_bits));
}

double Random::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  // Box-Muller: std::normal_distribution differs between standard libraries
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  const double angle_rad = 2.0 * geometry::kPi * uniform();
  spare_ = radius * std::sin(angle_rad);
  has_spare_ = true;
  return radius * std::cos(angle_rad);
}

}  // namespace orchard::simulation
