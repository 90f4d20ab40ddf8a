// SPDX-License-Identifier: BSD-3-Clause
#include "detection/picture_width.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "geometry/angles.hpp"
#include "geometry/statistics.hpp"

namespace orchard::detection {
namespace {

/// derived: pixels among which the median, Sobel's filter and non-maximum suppression make the
/// pixels of an edge map depend on each other, in both directions.
constexpr double kDependent_px =
    (vision::EdgeConfig::kMedianSize_px + 2) * (vision::EdgeConfig::kMedianSize_px + 2);
/// derived: Canny localises an edge to one pixel.
constexpr int kEdge_px = 1;
/// derived: rotation of laser to camera [rad], that of `orchard calibrate laser-camera`
/// (0.3 degrees): it moves both sides alike.
constexpr double kMount_rad = 0.3 * geometry::kPi / 180.0;
/// derived: 99.7 %.
constexpr double kReach_sigma = 3.0;
/// derived: variance of two sides, each uniform within the pixel that it is found in.
constexpr double kPixels_px2 = 2.0 / 12.0;

/// Logarithm of the gamma function, for several threads at once: std::lgamma writes a global sign.
double log_gamma(double x) {
  int sign = 0;
  return ::lgamma_r(x, &sign);
}

/// Log evidence that `hits` of `count` pixels are edges, over all densities.
double evidence(double hits, double count) {
  return log_gamma(hits + 1.0) + log_gamma(count - hits + 1.0) - log_gamma(count + 2.0);
}

/// The columns in which a side is searched, and how it divides them.
struct SideSearch {
  int begin_px = 0, end_px = 0;  ///< columns of the window
  double expected_px = 0.0;
  int first_px = 0;  ///< leftmost column to try
  bool is_left = false;

  /// Log evidence of each column tried, for sides that lean by `slope` columns per row.
  std::vector<double> operator()(const vision::EdgeMap& map, const vision::PixelRect& rows,
                                 double row_px, double slope, int num) const {
    const auto width = static_cast<std::size_t>(end_px - begin_px);
    std::vector<double> hits(width + 1), counts(width + 1);
    for (int y = rows.y_px; y < rows.y_px + rows.height_px; ++y) {
      const int shift = static_cast<int>(std::lround(slope * (y - row_px)));
      const auto line = static_cast<std::ptrdiff_t>(y - map.area.y_px) * map.area.width_px;
      for (std::size_t i = 0; i < width; ++i) {
        const int x = begin_px + static_cast<int>(i) + shift;
        if (x < rows.x_px || x >= rows.x_px + rows.width_px) continue;
        counts[i + 1] += 1.0 / kDependent_px;
        const auto at = static_cast<std::size_t>(line + x - map.area.x_px);
        if (map.edges[at] != 0) hits[i + 1] += 1.0 / kDependent_px;
      }
    }
    for (std::size_t i = 0; i < width; ++i) {
      hits[i + 1] += hits[i];
      counts[i + 1] += counts[i];
    }
    const auto between = [&](int from_px, int to_px) {
      const auto a = static_cast<std::size_t>(std::clamp(from_px, begin_px, end_px) - begin_px);
      const auto b = static_cast<std::size_t>(std::clamp(to_px, begin_px, end_px) - begin_px);
      return evidence(hits[b] - hits[a], std::max(counts[b] - counts[a], hits[b] - hits[a]));
    };
    std::vector<double> result;
    for (int x = first_px; x < first_px + num; ++x) {
      const int split_px = is_left ? x + 1 : x;  // an edge belongs to what is beside the trunk
      const double plain = between(begin_px, split_px) + between(split_px, end_px);
      const double lined = between(begin_px, x - kEdge_px) +
                           between(x - kEdge_px, x + kEdge_px + 1) +
                           between(x + kEdge_px + 1, end_px);
      result.push_back(std::max(plain, lined) + std::log1p(std::exp(-std::abs(plain - lined))));
    }
    return result;
  }
};

/// The most probable value and the variance about it.
struct Peak {
  double value = 0.0, variance = 0.0;
};

/// Of weights of -n to n.
Peak peak_of(const std::vector<double>& weights) {
  const auto at =
      static_cast<double>(std::max_element(weights.begin(), weights.end()) - weights.begin());
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += weights[i];
    squares += weights[i] * geometry::square(static_cast<double>(i) - at);
  }
  return {at - 0.5 * static_cast<double>(weights.size() - 1), squares / sum};
}

}  // namespace

std::optional<PictureWidth> picture_width(const vision::EdgeMap& map, const TrunkView& view,
                                          const laser::Segment& segment, double angle_sd_rad,
                                          const Rig& rig) {
  const double span_px = view.right_x_px - view.left_x_px;
  if (segment.occluded_left || segment.occluded_right || !(span_px > 0.0)) return std::nullopt;
  const double focal_px = rig.camera.intrinsics().fc_px[0];
  const double px_per_m = span_px / segment.width_m;
  const double laser_sd_px = px_per_m * segment.range_m * angle_sd_rad;
  const double side_sd_px = laser_sd_px / std::sqrt(2.0);
  const int half_rows = static_cast<int>(std::lround(0.5 * span_px));
  if (side_sd_px < kEdge_px || half_rows < 1) return std::nullopt;
  const double common_sd_px = focal_px * kMount_rad;

  // A trunk is straight over its own width, and a row outside the windows is not read.
  const vision::PixelRect windows = vision::bounding(view.left_edge, view.right_edge);
  const int row_px = static_cast<int>(std::lround(view.row_px));
  const vision::PixelRect rows = vision::intersection(
      windows, {windows.x_px, row_px - half_rows, windows.width_px, 2 * half_rows + 1});
  if (rows.empty()) return std::nullopt;
  const int reach_px = std::min(
      static_cast<int>(std::ceil(kReach_sigma * std::hypot(side_sd_px, common_sd_px))), half_rows);
  const int middle_px = static_cast<int>(std::lround(0.5 * (view.left_x_px + view.right_x_px)));
  const SideSearch left{
      view.left_edge.x_px, std::min(view.left_edge.x_px + view.left_edge.width_px, middle_px),
      view.left_x_px, static_cast<int>(std::lround(view.left_x_px)) - reach_px, true};
  const SideSearch right{std::max(view.right_edge.x_px, middle_px),
                         view.right_edge.x_px + view.right_edge.width_px, view.right_x_px,
                         static_cast<int>(std::lround(view.right_x_px)) - reach_px, false};
  if (left.begin_px >= left.end_px || right.begin_px >= right.end_px) return std::nullopt;

  const int num = 2 * reach_px + 1;
  const double steepest =
      std::tan(rig.detector.edges.max_tilt_deg * geometry::kPi / 180.0) * half_rows;
  struct Tilt {
    double slope = 0.0;
    std::vector<double> left, right;
  };
  std::vector<Tilt> tilts;
  double best = -1e300;
  for (double shift_px = -std::floor(steepest); shift_px <= steepest; shift_px += 1.0) {
    const double slope = shift_px / half_rows;
    tilts.push_back(
        {slope, left(map, rows, row_px, slope, num), right(map, rows, row_px, slope, num)});
    best =
        std::max(best, *std::max_element(tilts.back().left.begin(), tilts.back().left.end()) +
                           *std::max_element(tilts.back().right.begin(), tilts.back().right.end()));
  }
  // Of the difference of both sides from where the laser expects them.
  std::vector<double> picture(static_cast<std::size_t>(2 * num - 1)), fused = picture;
  double slope_sum = 0.0, weight_sum = 0.0;
  for (const Tilt& tilt : tilts) {
    for (int l = 0; l < num; ++l) {
      for (int r = 0; r < num; ++r) {
        const double left_px = left.first_px + l - left.expected_px;
        const double right_px = right.first_px + r - right.expected_px;
        const double wider_px = right_px - left_px, aside_px = 0.5 * (right_px + left_px);
        const double mount = geometry::square(aside_px) /
                             (geometry::square(common_sd_px) + 0.5 * geometry::square(side_sd_px));
        const double likely =
            std::exp(tilt.left[static_cast<std::size_t>(l)] +
                     tilt.right[static_cast<std::size_t>(r)] - best - 0.5 * mount);
        const double both = likely * std::exp(-0.5 * geometry::square(wider_px / laser_sd_px));
        picture[static_cast<std::size_t>(r - l + num - 1)] += likely;
        fused[static_cast<std::size_t>(r - l + num - 1)] += both;
        slope_sum += both * tilt.slope;
        weight_sum += both;
      }
    }
  }
  if (!(weight_sum > 0.0)) return std::nullopt;
  const double zero_px = right.first_px - right.expected_px - left.first_px + left.expected_px;
  // The error of the range is common to both angles.
  const double range_sd = std::hypot(rig.laser.range_sd_at(segment.range_m) / segment.range_m /
                                         std::sqrt(std::max(1, segment.num_beams)),
                                     rig.laser.target_sd_fraction);
  PictureWidth result;
  result.tilt_rad = std::atan(slope_sum / weight_sum);
  const double upright = std::cos(result.tilt_rad);  // a leaning trunk's section is wider than it
  const auto measured = [&](const Peak& wider_px) {
    const double width_m = upright * (span_px + wider_px.value) / px_per_m;
    return MeasuredWidth{
        width_m, std::hypot(upright * std::sqrt(wider_px.variance) / px_per_m, width_m * range_sd)};
  };
  const auto by_pixels = [&](const std::vector<double>& weights) {
    const Peak e = peak_of(weights);
    return measured({zero_px + e.value, e.variance + kPixels_px2});
  };
  result.laser = measured({0.0, geometry::square(laser_sd_px)});
  result.picture = by_pixels(picture);
  result.fused = by_pixels(fused);
  return result;
}

}  // namespace orchard::detection
