// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace orchard::mapping {

/// Spectrum of what stands along rows, at spacings from 0.3 to 15 m; those of several rows add up.
///
/// It is that of the distances within a few spacings (Blackman and Tukey 1958), so that steps may
/// differ and add up. Stems and shoots of plants blur its lines but do not move them.
class SpacingSpectrum {
 public:
  SpacingSpectrum();

  /// Adds a row: places along it [m], ascending, from anywhere. Nothing is added at spacings longer
  /// than its longest step.
  void add(const std::vector<double>& along_m);
  void add(const SpacingSpectrum& other) { power_ += other.power_; }

  /// Spacing at which the power of a line and its double is largest [m]; 0 if no two places are
  /// near each other. Stakes midway between plants make the second line stronger, and no other:
  /// where more than about a third of the gaps have one, half of the spacing wins.
  double strongest_m() const;

 private:
  Eigen::VectorXd power_;  ///< at spacings in a geometric series
};

}  // namespace orchard::mapping
