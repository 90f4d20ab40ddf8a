// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace orchard::mapping {

/// derived: plants of a row are not farther apart than this [m], the widest spacing of fruit trees.
inline constexpr double kSpacingMax_m = 15.0;

/// Power of what stands along rows at spacings from `least_m` to kSpacingMax_m, in a geometric
/// series: at each the sum of the spectrum at a line and its double. Those of several rows add up.
///
/// The spectrum is that of the distances within a few spacings (Blackman and Tukey 1958), so that
/// steps may differ and add up. Stems and shoots of plants blur its lines but do not move them;
/// stakes midway between plants make the second line stronger, and no other.
class SpacingSpectrum {
 public:
  explicit SpacingSpectrum(double least_m);

  /// Adds a row: places along it [m], ascending, from anywhere.
  void add(const std::vector<double>& along_m);
  void add(const SpacingSpectrum& other) { power_ += other.power_; }

  /// Spacing of the largest power [m]; 0 if no two places are near each other.
  double strongest_m() const;

 private:
  Eigen::VectorXd spacings_m_, power_;
};

}  // namespace orchard::mapping
