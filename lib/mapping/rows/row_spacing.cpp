// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/row_spacing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "geometry/angles.hpp"
#include "mapping/tuning.hpp"

namespace orchard::mapping {
namespace {

/// derived: spacings in an octave, four to the width of a line, which the number of spacings in a
/// distance gives.
constexpr double kPerOctave = 4.0 * tuning::kReach_spacings;
/// derived: what is nearer than half a spacing is of one plant.
constexpr double kNearest_spacings = 0.5;

/// Sum over pairs of the cosine of their distance in spacings, weighted down to none at
/// kReach_spacings (Bartlett's window). Places at random give 0 on average, because the pairs span
/// whole spacings.
double power_at(const std::vector<double>& along_m, double spacing_m) {
  double power = 0.0;
  for (std::size_t i = 0; i < along_m.size(); ++i) {
    for (std::size_t j = i + 1; j < along_m.size(); ++j) {
      const double spacings = (along_m[j] - along_m[i]) / spacing_m;
      if (spacings > tuning::kReach_spacings) break;
      if (spacings < kNearest_spacings) continue;
      power +=
          (1.0 - spacings / tuning::kReach_spacings) * std::cos(2.0 * geometry::kPi * spacings);
    }
  }
  return power;
}

}  // namespace

SpacingSpectrum::SpacingSpectrum(double least_m) {
  const double octaves = std::max(0.0, std::log2(kSpacingMax_m / least_m));
  const auto num = static_cast<Eigen::Index>(kPerOctave * octaves) + 1;
  spacings_m_.resize(num);
  for (Eigen::Index k = 0; k < num; ++k) {
    spacings_m_(k) = least_m * std::exp2(static_cast<double>(k) / kPerOctave);
  }
  power_.setZero(num);
}

void SpacingSpectrum::add(const std::vector<double>& along_m) {
  for (Eigen::Index k = 0; k < power_.size(); ++k) {
    power_(k) += power_at(along_m, spacings_m_(k)) + power_at(along_m, 0.5 * spacings_m_(k));
  }
}

double SpacingSpectrum::strongest_m() const {
  Eigen::Index strongest = 0;
  return power_.maxCoeff(&strongest) > 0.0 ? spacings_m_(strongest) : 0.0;
}

}  // namespace orchard::mapping
