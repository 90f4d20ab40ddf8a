// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/extrinsics/stationary_views.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "geometry/statistics.hpp"

namespace orchard::calibration {
namespace {

/// Max deviation from the median range; well above the noise of a beam.
double near_m(double range_m) { return 0.03 + 0.03 * range_m; }

bool same_shape(const laser::Scan& a, const laser::Scan& b) {
  return a.ranges_m.size() == b.ranges_m.size() && a.bearing_min_rad == b.bearing_min_rad &&
         a.bearing_step_rad == b.bearing_step_rad;
}

}  // namespace

laser::Scan mean_scan(const std::vector<laser::Scan>& scans) {
  if (scans.empty()) throw std::invalid_argument("mean_scan: no scan");
  laser::Scan mean = scans[scans.size() / 2];
  if (scans.size() == 1) return mean;
  for (const laser::Scan& scan : scans) {
    if (!same_shape(scan, mean)) {
      throw std::invalid_argument("mean_scan: scans of different shapes");
    }
  }
  mean.intensities.clear();
  std::vector<double> ranges_m;
  for (std::size_t i = 0; i < mean.ranges_m.size(); ++i) {
    ranges_m.clear();
    for (const laser::Scan& scan : scans) {
      if (scan.valid(i)) ranges_m.push_back(scan.ranges_m[i]);
    }
    if (2 * ranges_m.size() <= scans.size()) {
      mean.ranges_m[i] = 0.0f;
      continue;
    }
    const double middle_m = geometry::median(ranges_m);
    double sum_m = 0.0;
    int num = 0;
    for (const double range_m : ranges_m) {
      if (std::abs(range_m - middle_m) > near_m(middle_m)) continue;
      sum_m += range_m;
      ++num;
    }
    mean.ranges_m[i] = static_cast<float>(sum_m / num);
  }
  return mean;
}

namespace {

// derived: budget; ten pairs cut the noise to a third.
constexpr std::size_t kMaxPairs = 10;

double largest_shift_px(const BoardView& a, const BoardView& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.corners_px.size(); ++i) {
    largest = std::max(largest, (a.corners_px[i] - b.corners_px[i]).norm());
  }
  return largest;
}

StationaryView mean_of(const std::vector<BoardPair>& pairs, std::size_t first, std::size_t last) {
  StationaryView view;
  view.board = pairs[first].board;
  view.num_pairs = static_cast<int>(last - first);
  std::vector<laser::Scan> scans;
  for (auto& corner : view.board.corners_px) corner.setZero();
  for (std::size_t i = first; i < last; ++i) {
    scans.push_back(pairs[i].scan);
    for (std::size_t k = 0; k < view.board.corners_px.size(); ++k) {
      view.board.corners_px[k] += pairs[i].board.corners_px[k] / view.num_pairs;
    }
  }
  view.scan = mean_scan(scans);
  return view;
}

/// Describes position and size of a board in the image by its first, last and middle corners.
std::vector<double> signature(const BoardView& board) {
  std::vector<double> numbers;
  const std::size_t n = board.corners_px.size();
  for (const std::size_t i : {std::size_t{0}, n / 3, n / 2, 2 * n / 3, n - 1}) {
    numbers.push_back(board.corners_px[i].x());
    numbers.push_back(board.corners_px[i].y());
  }
  return numbers;
}

}  // namespace

std::vector<StationaryView> stationary_views(const std::vector<BoardPair>& pairs,
                                             double shift_max_px) {
  std::vector<StationaryView> views;
  for (std::size_t first = 0; first < pairs.size();) {
    std::size_t last = first + 1;
    while (last < pairs.size() && last - first < kMaxPairs &&
           pairs[first].board.corners_m == pairs[last].board.corners_m &&
           same_shape(pairs[first].scan, pairs[last].scan) &&
           largest_shift_px(pairs[first].board, pairs[last].board) <= shift_max_px &&
           largest_shift_px(pairs[last - 1].board, pairs[last].board) <= shift_max_px) {
      ++last;
    }
    if (last - first >= 2) views.push_back(mean_of(pairs, first, last));
    first = last;
  }
  return views;
}

std::vector<StationaryView> single_views(const std::vector<BoardPair>& pairs) {
  std::vector<StationaryView> views;
  for (std::size_t i = 0; i < pairs.size(); ++i) views.push_back(mean_of(pairs, i, i + 1));
  return views;
}

std::vector<StationaryView> spread_subset(const std::vector<StationaryView>& views, int count) {
  if (static_cast<int>(views.size()) <= count || count < 1) return views;
  std::vector<std::vector<double>> places;
  for (const StationaryView& view : views) places.push_back(signature(view.board));
  std::vector<StationaryView> subset;
  for (const std::size_t i : most_different(places, static_cast<std::size_t>(count))) {
    subset.push_back(views[i]);
  }
  return subset;
}

}  // namespace orchard::calibration
