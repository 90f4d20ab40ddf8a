// SPDX-License-Identifier: BSD-3-Clause
#include "laser/segment.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "geometry/angles.hpp"

namespace orchard::laser {
namespace {

using geometry::kPi;
using geometry::wrap_angle_rad;

/// A beam's believable range, or 0.
constexpr float kNoReturn = 0.0f;

/// Share of the separating step that noise alone may make at the rim of an object.
constexpr double kRimNoiseShare = 0.35;

/// The beams of a scan in the order in which they are cut. A full turn starts at a gap, so that
/// no object lies across the seam.
class Beams {
 public:
  Beams(const Scan& scan, const SegmentationConfig& config)
      : config_(config), size_(static_cast<std::ptrdiff_t>(scan.ranges_m.size())) {
    const double turn_rad = std::abs(scan.bearing_step_rad) * static_cast<double>(size_);
    is_turn_ = size_ > 2 && std::abs(turn_rad - 2.0 * kPi) <= 1.5 * std::abs(scan.bearing_step_rad);
    believe(scan);
    if (is_turn_) start_ = first_gap();
  }

  std::ptrdiff_t size() const { return size_; }
  std::size_t index(std::ptrdiff_t i) const {
    const std::ptrdiff_t shifted = i + start_;
    return static_cast<std::size_t>(shifted >= size_ ? shifted - size_
                                    : shifted < 0    ? shifted + size_
                                                     : shifted);
  }
  float range_m(std::ptrdiff_t i) const { return ranges_m_[index(i)]; }
  /// Whether something (the robot, the end of the scan) keeps the laser from seeing there.
  bool blocked(std::ptrdiff_t i) const {
    if (!is_turn_ && (i < 0 || i >= size_)) return true;
    return blocked_[index((i + size_) % size_)];
  }
  /// As range_m(), beyond the ends too: no return there, or the other end of a full turn.
  float range_around_m(std::ptrdiff_t i) const {
    if (!is_turn_ && (i < 0 || i >= size_)) return kNoReturn;
    return ranges_m_[index((i + size_) % size_)];
  }
  double jump_m(double range_m) const { return config_.jump_m + config_.jump_fraction * range_m; }
  bool joined(double a_m, double b_m) const {
    return a_m > 0.0 && b_m > 0.0 && std::abs(a_m - b_m) <= jump_m(std::min(a_m, b_m));
  }

 private:
  void believe(const Scan& scan) {
    const double nearest_m = std::max(scan.range_min_m, config_.range_min_m);
    const double farthest_m = std::min(scan.range_max_m, config_.range_max_m);
    ranges_m_.assign(scan.ranges_m.size(), kNoReturn);
    blocked_.assign(scan.ranges_m.size(), 0);
    const bool has_blind_sector = config_.blind_half_width_rad > 0.0;
    for (std::size_t i = 0; i < ranges_m_.size(); ++i) {
      const float range_m = scan.ranges_m[i];
      const bool blind =
          has_blind_sector &&
          std::abs(wrap_angle_rad(scan.bearing_rad(static_cast<double>(i)) -
                                  config_.blind_centre_rad)) <= config_.blind_half_width_rad;
      // false for NaN as well
      if (!blind && range_m >= nearest_m && range_m <= farthest_m && range_m > 0.0f) {
        ranges_m_[i] = range_m;
      } else {
        // what goes on just beyond the farthest range ends where it is cut, not where it ends
        const bool cut_off = range_m > farthest_m && range_m <= farthest_m + jump_m(farthest_m);
        blocked_[i] = blind || cut_off || (range_m > 0.0f && range_m < nearest_m);
      }
    }
  }

  std::ptrdiff_t first_gap() const {
    for (std::ptrdiff_t i = 0; i < size_; ++i) {
      const float before_m = ranges_m_[static_cast<std::size_t>((i + size_ - 1) % size_)];
      const float before_last_m = ranges_m_[static_cast<std::size_t>((i + size_ - 2) % size_)];
      const float here_m = ranges_m_[static_cast<std::size_t>(i)];
      const float next_m = ranges_m_[static_cast<std::size_t>((i + 1) % size_)];
      // neither neighbours nor a bridge over one beam join here
      if (!joined(before_m, here_m) && !joined(before_last_m, here_m) &&
          !joined(before_m, next_m)) {
        return i;
      }
    }
    return 0;
  }

  const SegmentationConfig& config_;
  std::ptrdiff_t size_;
  std::ptrdiff_t start_ = 0;
  bool is_turn_ = false;
  std::vector<float> ranges_m_;
  std::vector<char> blocked_;
};

/// Neighbouring beams on one surface; positions in Beams.
struct Run {
  std::ptrdiff_t first = 0;
  std::ptrdiff_t last = 0;
  int num_beams = 0;
};

/// Whether beam `i`, joined to both neighbours, is the one beam of a step from one surface to
/// another: the step is as high as one that separates, and flat ground lies on both sides.
bool is_step_between_surfaces(const Beams& beams, std::ptrdiff_t before, std::ptrdiff_t i) {
  if (i + 2 >= beams.size() || before < 1) return false;
  const double low_m = beams.range_m(before);
  const double high_m = beams.range_m(i + 1);
  const double here_m = beams.range_m(i);
  if (high_m <= 0.0f) return false;
  const double step_m = high_m - low_m;
  if (std::abs(step_m) <= beams.jump_m(std::min(low_m, high_m))) return false;
  if ((here_m - low_m) * step_m <= 0.0 || (high_m - here_m) * step_m <= 0.0) return false;
  const auto flat = [&](double a_m, double b_m) {
    return a_m <= 0.0 || b_m <= 0.0 || std::abs(a_m - b_m) < 0.25 * std::abs(step_m);
  };
  return flat(beams.range_m(before - 1), low_m) && flat(high_m, beams.range_m(i + 2));
}

/// Cuts the beams at the spikes of their derivative.
std::vector<Run> cut(const Beams& beams) {
  std::vector<Run> runs;
  std::optional<Run> run;
  const auto close = [&] {
    if (run) runs.push_back(*run);
    run.reset();
  };
  for (std::ptrdiff_t i = 0; i < beams.size(); ++i) {
    const float here_m = beams.range_m(i);
    if (run) {
      const float last_m = beams.range_m(run->last);
      const std::ptrdiff_t gap = i - run->last;
      if (beams.joined(last_m, here_m)) {
        if (gap == 1 && is_step_between_surfaces(beams, run->last, i)) {
          close();
          continue;  // the beam between belongs to neither
        }
        run->last = i;
        ++run->num_beams;
        continue;
      }
      const bool bridgeable = here_m <= 0.0f || (here_m < last_m && i + 1 < beams.size());
      if (gap == 1 && bridgeable && i + 1 < beams.size() &&
          beams.joined(last_m, beams.range_m(i + 1)) &&
          !beams.joined(here_m, beams.range_m(i + 1))) {
        continue;  // one beam missing, or on something thin in front
      }
      close();
    }
    if (here_m > 0.0f) run = Run{i, i, 1};
  }
  close();
  return runs;
}

/// Takes off a beam at the rim that is half on the object and half on what is behind or in front
/// of it: a round surface cannot recede that fast. A chord of beam spacing s at the rim of a
/// circle of radius R is at most sqrt(2 R s) deep.
void trim_rim(const Beams& beams, double step_rad, Run& run) {
  for (const bool at_end : {false, true}) {
    if (run.num_beams < 3) return;
    const std::ptrdiff_t rim = at_end ? run.last : run.first;
    const std::ptrdiff_t inwards = at_end ? -1 : 1;
    const std::ptrdiff_t outside = rim - inwards;
    std::ptrdiff_t inner = rim + inwards;
    while (beams.range_m(inner) <= 0.0f ||
           !beams.joined(beams.range_m(rim), beams.range_m(inner))) {
      inner += inwards;
      if (inner == (at_end ? run.first : run.last)) break;
    }
    // only a rim that borders on another surface can be mixed with it
    if (beams.range_around_m(outside) <= 0.0f) continue;
    const double range_m = beams.range_m(inner);
    const double spacing_m = range_m * step_rad;
    const double radius_m = 0.5 * static_cast<double>(run.last - run.first) * spacing_m;
    const double limb_m = std::min(radius_m, std::sqrt(2.0 * radius_m * spacing_m));
    const double rise_m = beams.range_m(rim) - range_m;
    const double outside_m = beams.range_around_m(outside) - range_m;
    if (rise_m * outside_m > 0.0 && std::abs(outside_m) > std::abs(rise_m) &&
        std::abs(rise_m) > limb_m + kRimNoiseShare * beams.jump_m(range_m)) {
      (at_end ? run.last : run.first) = inner;
      --run.num_beams;
    }
  }
}

/// Whether a lone beam lies between the two surfaces beside it.
bool is_mixed(const Beams& beams, const Run& run) {
  const float before_m = beams.range_around_m(run.first - 1);
  const float after_m = beams.range_around_m(run.first + 1);
  const float here_m = beams.range_m(run.first);
  return before_m > 0.0f && after_m > 0.0f && (here_m - before_m) * (after_m - here_m) > 0.0f;
}

/// Whether something nearer stands within two beams of an object's end.
bool is_occluded(const Beams& beams, std::ptrdiff_t end, std::ptrdiff_t outwards) {
  if (beams.blocked(end + outwards)) return true;
  const double range_m = beams.range_m(end);
  for (const std::ptrdiff_t k : {1, 2}) {
    const double outside_m = beams.range_around_m(end + k * outwards);
    if (outside_m > 0.0 && outside_m < range_m - beams.jump_m(outside_m)) return true;
  }
  return false;
}

double chord_m(double r1_m, double r2_m, double angle_rad) {
  const double square_m2 = r1_m * r1_m + r2_m * r2_m - 2.0 * r1_m * r2_m * std::cos(angle_rad);
  return std::sqrt(std::max(0.0, square_m2));
}

Segment measure(const Scan& scan, const Beams& beams, const Run& run,
                const SegmentationConfig& config, const WidthConfig& width) {
  const double step_rad = std::abs(scan.bearing_step_rad);
  const double span_beams = static_cast<double>(run.last - run.first);
  Segment s;
  s.first_beam = beams.index(run.first);
  s.last_beam = beams.index(run.last);
  s.middle_beam = beams.index(run.first + (run.last - run.first) / 2);
  s.num_beams = run.num_beams;
  s.start_range_m = beams.range_m(run.first);
  s.end_range_m = beams.range_m(run.last);

  double sum_m = 0.0;
  double nearest_m = s.start_range_m;
  double farthest_m = s.start_range_m;
  for (std::ptrdiff_t i = run.first; i <= run.last; ++i) {
    const double range_m = beams.range_m(i);
    // a bridged beam is missing or lies in front
    if (range_m <= 0.0 || i == run.first) {
      sum_m += i == run.first ? range_m : 0.0;
      continue;
    }
    const bool in_front = !beams.joined(range_m, beams.range_m(i - 1)) && i < run.last &&
                          !beams.joined(range_m, beams.range_m(i + 1));
    if (in_front) continue;
    sum_m += range_m;
    nearest_m = std::min(nearest_m, range_m);
    farthest_m = std::max(farthest_m, range_m);
  }
  const double mean_m = sum_m / run.num_beams;
  s.depth_m = farthest_m - nearest_m;

  // A circle of radius R at distance D fills the angle 2 asin(R / D), and its surface lies on
  // average D - pi/4 R away over that angle.
  const double half_angle_rad = std::min(0.5 * (span_beams + 1.0) * step_rad, 0.5 * kPi);
  const double sine = std::sin(half_angle_rad);
  const double radius_m = mean_m * sine / (1.0 - 0.25 * kPi * sine);
  const double to_front_m = (1.0 - 0.25 * kPi) * radius_m;
  s.range_m = std::clamp(mean_m - to_front_m, nearest_m, farthest_m);

  const double paper_m = chord_m(s.start_range_m, s.end_range_m, span_beams * step_rad);
  if (width.mode == WidthMode::kPaper) {
    s.width_m = paper_m;
  } else {
    // what is not round but slants away is as wide as its slant
    const double slant_m = std::abs(s.end_range_m - s.start_range_m);
    const bool slants = slant_m > radius_m + config.jump_m;
    s.width_m = slants ? std::max(2.0 * radius_m, paper_m + mean_m * step_rad) : 2.0 * radius_m;
  }
  // each edge falls anywhere within its beam step: sd of the difference of two uniforms
  const double quantum_m = mean_m * step_rad / std::sqrt(6.0);
  s.width_sd_m = std::max(quantum_m, 0.1 * width.sd_floor_m);

  const double edge_beams = width.mode == WidthMode::kPaper ? 0.0 : 0.5;
  const double first = static_cast<double>(s.first_beam);
  s.start_bearing_rad = scan.bearing_rad(first - edge_beams);
  s.end_bearing_rad = scan.bearing_rad(first + span_beams + edge_beams);
  s.bearing_rad = wrap_angle_rad(scan.bearing_rad(first + 0.5 * span_beams));

  const bool occluded_before = is_occluded(beams, run.first, -1);
  const bool occluded_after = is_occluded(beams, run.last, 1);
  s.occluded_right = scan.bearing_step_rad > 0.0 ? occluded_before : occluded_after;
  s.occluded_left = scan.bearing_step_rad > 0.0 ? occluded_after : occluded_before;
  return s;
}

}  // namespace

std::vector<Segment> segment(const Scan& scan, const SegmentationConfig& segmentation,
                             const WidthConfig& width) {
  std::vector<Segment> segments;
  if (scan.ranges_m.empty() || !std::isfinite(scan.bearing_step_rad) ||
      scan.bearing_step_rad == 0.0 || !std::isfinite(scan.bearing_min_rad)) {
    return segments;
  }
  const Beams beams(scan, segmentation);
  for (Run run : cut(beams)) {
    trim_rim(beams, std::abs(scan.bearing_step_rad), run);
    if (run.num_beams < segmentation.min_beams) continue;
    if (run.num_beams == 1 && is_mixed(beams, run)) continue;
    const Segment s = measure(scan, beams, run, segmentation, width);
    if (s.width_m <= segmentation.width_max_m) segments.push_back(s);
  }
  std::sort(segments.begin(), segments.end(), [](const Segment& a, const Segment& b) {
    return a.bearing_rad != b.bearing_rad ? a.bearing_rad < b.bearing_rad
                                          : a.first_beam < b.first_beam;
  });
  return segments;
}

double width_sigma_m(double range_m, double bearing_step_rad, const WidthConfig& width) {
  const double quantum_m = width.sd_per_beam_step * range_m * std::abs(bearing_step_rad);
  return std::hypot(std::max(width.sd_m, width.sd_floor_m), quantum_m);
}

double roc_laser(double width_m, double range_m, double bearing_step_rad,
                 const WidthConfig& width) {
  const double sigma_m = width_sigma_m(range_m, bearing_step_rad, width);
  const double deviation = (width_m - width.mean_m) / sigma_m;
  return std::exp(-0.5 * deviation * deviation);
}

}  // namespace orchard::laser
