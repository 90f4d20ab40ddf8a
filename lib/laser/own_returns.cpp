// SPDX-License-Identifier: BSD-3-Clause
#include "laser/own_returns.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/statistics.hpp"
#include "laser/tuning.hpp"

namespace orchard::laser {
namespace {

/// derived: max range difference between two returns from one object, in standard deviations; noise
/// exceeds it in 1 of 16,000 pairs.
constexpr double kSigmas = 4.0;
/// derived: min number of scans used before found() reports anything: a fraction of 0.5 is then
/// known to 0.07.
constexpr int kScansMin = 50;
/// physical: the range bins cover 3 m: no robot extends farther from its scanner.
constexpr double kBin_m = 0.1;
constexpr std::size_t kNumBins = 30;
/// derived: min fraction of scans at the borders of an object that travels along.
constexpr double kSometimes = 2.0 * tuning::kRarely;

}  // namespace

double OwnReturns::bearing_rad(std::size_t beam) const {
  return bearing_min_rad_ + static_cast<double>(beam) * bearing_step_rad_;
}

/// Whether more than half of the beams with a return in either scan have changed: another range, or
/// a return in only one of the scans.
bool OwnReturns::has_moved(const Scan& scan) const {
  std::size_t num = 0, num_changed = 0;
  for (std::size_t i = 0; i < last_m_.size(); ++i) {
    const double was_m = last_m_[i], is_m = scan.valid(i) ? scan.ranges_m[i] : 0.0;
    if (was_m == 0.0 && is_m == 0.0) continue;
    const double sd2_m2 =
        geometry::square(config_.range_sd_m) + geometry::square(config_.range_sd_fraction * was_m);
    const bool is_apart = geometry::square(was_m - is_m) > kSigmas * kSigmas * sd2_m2;
    ++num;
    if (was_m == 0.0 || is_m == 0.0 || is_apart) ++num_changed;
    if (2 * num_changed > last_m_.size()) return true;  // whatever the others are
  }
  return 2 * num_changed > num;
}

void OwnReturns::add(const Scan& scan) {
  const bool is_new = last_m_.size() != scan.ranges_m.size() ||
                      bearing_min_rad_ != scan.bearing_min_rad ||
                      bearing_step_rad_ != scan.bearing_step_rad;
  if (is_new) {
    last_m_.assign(scan.ranges_m.size(), 0.0f);
    num_returns_.assign(scan.ranges_m.size() * kNumBins, 0);
    num_scans_ = 0;
    bearing_min_rad_ = scan.bearing_min_rad;
    bearing_step_rad_ = scan.bearing_step_rad;
  } else if (!has_moved(scan)) {
    return;
  }
  ++num_scans_;
  for (std::size_t i = 0; i < last_m_.size(); ++i) {
    last_m_[i] = scan.valid(i) ? scan.ranges_m[i] : 0.0f;
    if (last_m_[i] < config_.range_min_m || last_m_[i] >= config_.range_max_m) continue;
    const auto bin = static_cast<std::size_t>(last_m_[i] / kBin_m);
    if (last_m_[i] > 0.0f && bin < kNumBins) ++num_returns_[i * kNumBins + bin];
  }
}

/// For each beam, the fraction of scans with a return within the first `num_bins` range bins; 0 in
/// the configured blind sector.
std::vector<double> OwnReturns::fractions_within(std::size_t num_bins) const {
  std::vector<double> fractions(last_m_.size(), 0.0);
  for (std::size_t i = 0; i < fractions.size(); ++i) {
    if (config_.blind.contains(bearing_rad(i))) continue;
    int num = 0;
    for (std::size_t bin = 0; bin < num_bins; ++bin) num += num_returns_[i * kNumBins + bin];
    fractions[i] = static_cast<double>(num) / num_scans_;
  }
  return fractions;
}

/// The clearance in range bins: the largest range within which at most tuning::kOwnViewMax of the
/// beams have returns in more than tuning::kRarely of the scans. None if there is no such range.
std::optional<std::size_t> OwnReturns::clear_bins() const {
  for (std::size_t num_bins = kNumBins; num_bins > 0; --num_bins) {
    std::vector<double> fractions = fractions_within(num_bins);
    const auto world =
        fractions.begin() + static_cast<std::ptrdiff_t>((1.0 - tuning::kOwnViewMax) *
                                                        static_cast<double>(fractions.size()));
    std::nth_element(fractions.begin(), world, fractions.end());
    if (*world <= tuning::kRarely) return num_bins;
  }
  return std::nullopt;
}

std::optional<OwnReturn> OwnReturns::found() const {
  if (num_scans_ < kScansMin) return std::nullopt;
  const auto num_bins = clear_bins();
  if (!num_bins) return std::nullopt;
  const BlindSector sector = hiding(fractions_within(*num_bins));
  if (sector.half_width_rad == 0.0) return std::nullopt;
  return OwnReturn{kBin_m * static_cast<double>(*num_bins), sector};
}

/// The narrowest sector around all beams that show an object that travels along, and around the
/// configured blind sector. Width 0 if there is no such beam.
BlindSector OwnReturns::hiding(const std::vector<double>& fractions) const {
  struct Arc {
    double from_rad, length_rad;
  };
  std::vector<Arc> arcs;
  const double step_rad = std::abs(bearing_step_rad_);
  const std::size_t num = fractions.size();
  for (std::size_t first = 0; first < num; ++first) {
    if (fractions[first] < kSometimes) continue;
    std::size_t last = first;
    int num_often = 0;
    for (; last < num && fractions[last] >= kSometimes; ++last)
      num_often += fractions[last] >= tuning::kOften;
    if (num_often >= config_.min_beams) {
      const double middle = 0.5 * static_cast<double>(first + last - 1);
      const double length_rad = step_rad * static_cast<double>(last - first);
      arcs.push_back(
          {bearing_min_rad_ + middle * bearing_step_rad_ - 0.5 * length_rad, length_rad});
    }
    first = last;
  }
  if (arcs.empty()) return {};
  const BlindSector& blind = config_.blind;
  if (blind.half_width_rad > 0.0) {
    arcs.push_back({blind.centre_rad - blind.half_width_rad, 2.0 * blind.half_width_rad});
  }
  // Candidates: sectors that begin at the start of one arc and extend to the farthest end of any.
  BlindSector narrowest{0.0, geometry::kPi};
  for (const Arc& start : arcs) {
    double length_rad = 0.0;
    for (const Arc& arc : arcs) {
      const double turn_rad = geometry::wrap_angle_rad(arc.from_rad - start.from_rad);
      const double after_rad = turn_rad < 0.0 ? turn_rad + 2.0 * geometry::kPi : turn_rad;
      length_rad = std::max(length_rad, after_rad + arc.length_rad);
    }
    if (0.5 * length_rad >= narrowest.half_width_rad) continue;
    narrowest = {geometry::wrap_angle_rad(start.from_rad + 0.5 * length_rad), 0.5 * length_rad};
  }
  return narrowest;
}

}  // namespace orchard::laser
