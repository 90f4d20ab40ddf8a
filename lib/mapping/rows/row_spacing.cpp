// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/row_spacing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "geometry/angles.hpp"
#include "mapping/tuning.hpp"

namespace orchard::mapping {
namespace {

/// physical: below the closest planting of trees, 0.5 m of super-spindle apples.
constexpr double kSpacingMin_m = 0.3;
/// derived: spacings in an octave, two to the width of a line, which the number of spacings in a
/// distance gives.
constexpr int kPerOctave = static_cast<int>(2.0 * tuning::kReach_spacings);
/// derived: octaves from half of kSpacingMin_m, its double line, to 15 m, the widest planting.
constexpr double kOctaves = 6.65;
/// derived: what is nearer than half a spacing is of one plant.
constexpr double kNearest_spacings = 0.5;

double spacing_m(Eigen::Index k) {
  return 0.5 * kSpacingMin_m * std::exp2(static_cast<double>(k) / kPerOctave);
}

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

SpacingSpectrum::SpacingSpectrum() {
  power_.setZero(static_cast<Eigen::Index>(kOctaves * kPerOctave) + 1);
}

void SpacingSpectrum::add(const std::vector<double>& along_m) {
  double longest_m = 0.0;
  for (std::size_t i = 1; i < along_m.size(); ++i) {
    longest_m = std::max(longest_m, along_m[i] - along_m[i - 1]);
  }
  for (Eigen::Index k = 0; k < power_.size() && spacing_m(k) <= longest_m; ++k) {
    power_(k) += power_at(along_m, spacing_m(k));
  }
}

double SpacingSpectrum::strongest_m() const {
  const Eigen::Index num = power_.size() - kPerOctave;
  Eigen::Index strongest = 0;
  const double most = (power_.head(num) + power_.tail(num)).maxCoeff(&strongest);
  return most > 0.0 ? spacing_m(strongest + kPerOctave) : 0.0;
}

}  // namespace orchard::mapping
