// SPDX-License-Identifier: BSD-3-Clause
#include "vision/edges.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <opencv2/core/hal/intrin.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>
#include <vector>

#include "geometry/angles.hpp"
#include "vision/block_view.hpp"
#include "vision/tuning.hpp"

namespace orchard::vision {
namespace {

using Row = std::vector<std::int16_t>;

constexpr int kLanes = cv::v_int16x8::nlanes;  // derived: of a SIMD register
/// derived: padding columns on each side of a row, so that every pixel has neighbours.
constexpr int kBorder_px = kLanes;
/// derived: tan(22.5 deg) x 2^15: limit between horizontal and diagonal gradients, as in OpenCV.
constexpr std::int16_t kTan22 = 13573;
constexpr std::int16_t kMaxGradient = 2 * 4 * 255;  // derived: both Sobel sums at most

enum Mark : std::uint8_t { kNone = 0, kWeak = 1, kStrong = 2 };

/// Gradients of one image row; size is 0 in the padding.
struct GradientRow {
  explicit GradientRow(std::size_t length) : dx(length), dy(length), size(length) {}
  Row dx, dy, size;
};

/// Computes the Sobel 3 x 3 gradients of row `y`. `smooth` and `slope` are scratch rows.
void fill_gradient(const std::uint8_t* grey, int width_px, int height_px, int y, Row& smooth,
                   Row& slope, GradientRow& out) {
  const auto row_at = [=](int row) {
    return grey + static_cast<std::size_t>(std::clamp(row, 0, height_px - 1)) *
                      static_cast<std::size_t>(width_px);
  };
  const std::uint8_t* above = row_at(y - 1);
  const std::uint8_t* here = row_at(y);
  const std::uint8_t* below = row_at(y + 1);
  std::int16_t* s = smooth.data() + kBorder_px;
  std::int16_t* d = slope.data() + kBorder_px;
  for (int x = 0; x < width_px; ++x) {
    s[x] = static_cast<std::int16_t>(above[x] + 2 * here[x] + below[x]);
    d[x] = static_cast<std::int16_t>(below[x] - above[x]);
  }
  s[-1] = s[0];
  d[-1] = d[0];
  s[width_px] = s[width_px - 1];
  d[width_px] = d[width_px - 1];
  std::int16_t* dx = out.dx.data() + kBorder_px;
  std::int16_t* dy = out.dy.data() + kBorder_px;
  std::int16_t* size = out.size.data() + kBorder_px;
  for (int x = 0; x < width_px; ++x) {
    const auto across = static_cast<std::int16_t>(s[x + 1] - s[x - 1]);
    const auto down = static_cast<std::int16_t>(d[x - 1] + 2 * d[x] + d[x + 1]);
    dx[x] = across;
    dy[x] = down;
    size[x] =
        static_cast<std::int16_t>((across < 0 ? -across : across) + (down < 0 ? -down : down));
  }
}

/// Non-maximum suppression: marks pixels whose gradient is above `low` and a maximum along its
/// direction, rounded to one of four. Branch-free on eight pixels at a time, because branches would
/// be unpredictable on texture.
void mark_ridges(const GradientRow& above, const GradientRow& here, const GradientRow& below,
                 int width_px, std::int16_t low, std::int16_t high, std::uint8_t* marks) {
  using cv::v_int16x8;
  const v_int16x8 tan22 = cv::v_setall_s16(kTan22);
  const v_int16x8 zero = cv::v_setzero_s16(), one = cv::v_setall_s16(1);
  const v_int16x8 lowest = cv::v_setall_s16(low), highest = cv::v_setall_s16(high);
  for (int x = 0; x < width_px; x += kLanes) {
    const int i = kBorder_px + x;
    const std::int16_t* up = above.size.data() + i;
    const std::int16_t* level = here.size.data() + i;
    const std::int16_t* down = below.size.data() + i;
    const v_int16x8 size = cv::v_load(level);
    if (!cv::v_check_any(size > lowest)) continue;  // the marks are kNone already
    const v_int16x8 dx = cv::v_load(here.dx.data() + i), dy = cv::v_load(here.dy.data() + i);
    const v_int16x8 wide = cv::v_max(dx, zero - dx), high_dy = cv::v_max(dy, zero - dy);
    // |dx| tan(22.5 deg), rounded down. The exact value is an integer only at 0, so <= the rounded
    // value is the same as < the exact one.
    const v_int16x8 bound = cv::v_mul_hi(wide + wide, tan22);
    const v_int16x8 is_across = high_dy <= bound;
    const v_int16x8 is_upright = high_dy - (wide + wide) > bound;  // tan 67.5 = tan 22.5 + 2
    const v_int16x8 falls = (dx ^ dy) >= zero;

    const v_int16x8 slanting_before = cv::v_select(falls, cv::v_load(up - 1), cv::v_load(up + 1));
    const v_int16x8 slanting_after =
        cv::v_select(falls, cv::v_load(down + 1), cv::v_load(down - 1));
    const v_int16x8 before =
        cv::v_select(is_across, cv::v_load(level - 1),
                     cv::v_select(is_upright, cv::v_load(up), slanting_before));
    // Of two equal gradients the first is the maximum horizontally and vertically, none diagonally.
    const v_int16x8 after =
        cv::v_select(is_across, cv::v_load(level + 1) - one,
                     cv::v_select(is_upright, cv::v_load(down) - one, slanting_after));
    const v_int16x8 is_ridge = (size > lowest) & (size > before) & (size > after);
    const v_int16x8 mark = is_ridge & (one + ((size > highest) & one));
    cv::v_pack_store(reinterpret_cast<std::int8_t*>(marks + x), mark);
  }
}

/// Whether one of the eight neighbours is weak; compares the three marks of each row at once.
bool has_weak_neighbour(const std::uint8_t* mark, std::ptrdiff_t step) {
  std::uint32_t any = 0;
  for (const std::ptrdiff_t offset : {-step, std::ptrdiff_t{0}, step}) {
    std::uint32_t four;
    std::memcpy(&four, mark + offset - 1, sizeof four);
    any |= four;
  }
  constexpr std::uint8_t kThree[] = {kWeak, kWeak, kWeak, 0};  // derived: independent of byte order
  std::uint32_t three;
  std::memcpy(&three, kThree, sizeof three);
  return (any & three) != 0;
}

/// Hysteresis: makes all weak marks strong that are connected to a strong one. The marks have a
/// border of kNone.
void spread_strong(std::vector<std::uint8_t>& marks, std::size_t stride) {
  std::vector<std::uint8_t*> waiting;
  waiting.reserve(1024);
  std::uint8_t* const end = marks.data() + marks.size();
  const auto step = static_cast<std::ptrdiff_t>(stride);
  const std::ptrdiff_t neighbours[] = {-step - 1, -step,    -step + 1, -1,
                                       1,         step - 1, step,      step + 1};
  const auto next_strong = [end](std::uint8_t* from) {
    return static_cast<std::uint8_t*>(
        std::memchr(from, kStrong, static_cast<std::size_t>(end - from)));
  };
  for (std::uint8_t* seed = next_strong(marks.data()); seed; seed = next_strong(seed + 1)) {
    if (!has_weak_neighbour(seed, step)) continue;  // most edges
    waiting.push_back(seed);
    while (!waiting.empty()) {
      std::uint8_t* mark = waiting.back();
      waiting.pop_back();
      if (!has_weak_neighbour(mark, step)) continue;
      for (const std::ptrdiff_t offset : neighbours) {
        if (mark[offset] != kWeak) continue;
        mark[offset] = kStrong;
        waiting.push_back(mark + offset);
      }
    }
  }
}

std::int16_t whole_size(double threshold) {
  return static_cast<std::int16_t>(
      std::clamp(std::floor(threshold), 0.0, static_cast<double>(kMaxGradient)));
}

}  // namespace

std::vector<std::uint8_t> canny(const std::uint8_t* grey, int width_px, int height_px, double low,
                                double high) {
  const auto width = static_cast<std::size_t>(width_px);
  const auto height = static_cast<std::size_t>(height_px);
  std::vector<std::uint8_t> edges(width * height);
  if (edges.empty()) return edges;
  // Padding on both sides, and a multiple of kLanes between.
  const std::size_t stride = (width + kLanes - 1) / kLanes * kLanes + 2 * kBorder_px;
  Row smooth(stride), slope(stride);
  GradientRow above(stride), here(stride), below(stride);
  std::vector<std::uint8_t> marks(stride * (height + 2));
  fill_gradient(grey, width_px, height_px, 0, smooth, slope, here);
  for (int y = 0; y < height_px; ++y) {
    if (y + 1 < height_px) {
      fill_gradient(grey, width_px, height_px, y + 1, smooth, slope, below);
    } else {
      std::fill(below.size.begin(), below.size.end(), std::int16_t{0});
    }
    mark_ridges(above, here, below, width_px, whole_size(low), whole_size(high),
                marks.data() + stride * static_cast<std::size_t>(y + 1) + kBorder_px);
    std::swap(above, here);
    std::swap(here, below);
  }
  spread_strong(marks, stride);
  for (std::size_t y = 0; y < height; ++y) {
    const std::uint8_t* from = marks.data() + stride * (y + 1) + kBorder_px;
    std::uint8_t* to = edges.data() + width * y;
    for (std::size_t x = 0; x < width; ++x) to[x] = from[x] == kStrong ? 255 : 0;
  }
  return edges;
}

namespace {

/// derived: the tolerance of a line; step between two tried slopes, in columns at the bottom row.
constexpr int kShiftStep_px = 2;

struct Moments {
  double x_mean = 0.0, y_mean = 0.0;
  double xx = 0.0, xy = 0.0, yy = 0.0;  ///< sums of squares about the mean
};

Moments moments_of(const std::vector<EdgePoint>& points) {
  // Integer sums are exact in any order.
  std::int64_t sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;
  for (const EdgePoint& p : points) {
    const std::int64_t x = p.x_px, y = p.y_px;
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
    syy += y * y;
  }
  const auto n = static_cast<double>(points.size());
  Moments m;
  m.x_mean = static_cast<double>(sx) / n;
  m.y_mean = static_cast<double>(sy) / n;
  m.xx = static_cast<double>(sxx) - n * m.x_mean * m.x_mean;
  m.xy = static_cast<double>(sxy) - n * m.x_mean * m.y_mean;
  m.yy = static_cast<double>(syy) - n * m.y_mean * m.y_mean;
  return m;
}

}  // namespace

double Line::x_at(double y_px) const { return x_mean_px + std::tan(tilt_rad) * (y_px - y_mean_px); }

std::optional<Line> fit_total_least_squares(const std::vector<EdgePoint>& points) {
  if (points.size() < 2) return std::nullopt;
  const Moments m = moments_of(points);
  const double half_trace = 0.5 * (m.xx + m.yy);
  const double root = std::hypot(0.5 * (m.yy - m.xx), m.xy);
  const double lambda_max = half_trace + root;
  if (!(lambda_max > 0.0)) return std::nullopt;
  const double lambda_min = std::max(half_trace - root, 0.0);
  Line line;
  line.x_mean_px = m.x_mean;
  line.y_mean_px = m.y_mean;
  // Angle of the principal axis from the vertical.
  line.tilt_rad = 0.5 * std::atan2(2.0 * m.xy, m.yy - m.xx);
  line.straightness = 1.0 - lambda_min / lambda_max;
  return line;
}

std::optional<Line> fit_regression(const std::vector<EdgePoint>& points) {
  if (points.size() < 2) return std::nullopt;
  const Moments m = moments_of(points);
  if (!(m.yy > 0.0)) return std::nullopt;
  Line line;
  line.x_mean_px = m.x_mean;
  line.y_mean_px = m.y_mean;
  line.tilt_rad = std::atan(m.xy / m.yy);
  // R^2 of the regression (Shalal et al. 2013, section 4.2 and figure 9)
  line.straightness = m.xx > 0.0 ? std::clamp(m.xy * m.xy / (m.xx * m.yy), 0.0, 1.0) : 0.0;
  return line;
}

std::vector<EdgePoint> points_of_best_line(const std::vector<EdgePoint>& points, int width_px,
                                           int height_px, double expected_x_px, double inlier_px,
                                           double max_tilt_rad) {
  // A line is given by its column in the top row and its shift in columns down to the bottom row.
  // All lines are tried in steps no coarser than the tolerance and scored by their number of
  // points. An edge is one pixel wide, so this is the number of rows that it covers.
  const int last_row = std::max(height_px - 1, 1);
  const int max_shift = static_cast<int>(std::tan(max_tilt_rad) * last_row);
  const int reach = std::max(static_cast<int>(std::lround(inlier_px)), 0);
  const double middle_y_px = 0.5 * (height_px - 1);
  int best_points = 0;
  double best_distance_px = 0.0, best_top = 0.0, best_slope = 0.0;
  // One column for each position at which a line near the window may cross the top row.
  const int border = max_shift + reach + 1;
  std::vector<int> padded(static_cast<std::size_t>(width_px + 2 * (border + reach)));
  int* const columns = padded.data() + reach;
  for (int shift = -max_shift; shift <= max_shift; shift += kShiftStep_px) {
    const double slope = static_cast<double>(shift) / last_row;
    // Only these columns have lines with this shift that pass through the window.
    const int first = border - std::max(shift, 0) - reach;
    const int last = border + width_px - std::min(shift, 0) + reach;
    std::fill(padded.begin(), padded.end(), 0);
    for (const EdgePoint& p : points) {
      ++columns[static_cast<int>(p.x_px - slope * p.y_px + (border + 0.5))];
    }
    int num_points = 0;
    for (int i = first; i <= last; ++i) {
      num_points += columns[i + reach];
      if (num_points > 0 && num_points >= best_points) {
        const int top = i - border;
        const double distance_px = std::abs(top + slope * middle_y_px - expected_x_px);
        if (num_points > best_points || distance_px < best_distance_px) {
          best_points = num_points;
          best_distance_px = distance_px;
          best_top = top;
          best_slope = slope;
        }
      }
      num_points -= columns[i - reach];
    }
  }
  std::vector<EdgePoint> inliers;
  if (best_points == 0) return inliers;
  inliers.reserve(points.size());
  for (const EdgePoint& p : points) {
    if (std::abs(p.x_px - (best_top + best_slope * p.y_px)) <= inlier_px) inliers.push_back(p);
  }
  return inliers;
}

namespace {

/// derived: max distance of an edge pixel from its line [px]; Canny localises an edge to one pixel.
constexpr double kInlier_px = 1.0;

constexpr double kRadPerDeg = geometry::kPi / 180.0;  // derived: as it says

/// The map's edge pixels inside the window, relative to its top left corner, row by row.
std::vector<EdgePoint> edge_points(const EdgeMap& map, const PixelRect& window) {
  std::vector<EdgePoint> points;
  points.reserve(256);
  for (int y = 0; y < window.height_px; ++y) {
    const std::uint8_t* row = map.edges.data() +
                              static_cast<std::size_t>(window.y_px - map.area.y_px + y) *
                                  static_cast<std::size_t>(map.area.width_px) +
                              static_cast<std::size_t>(window.x_px - map.area.x_px);
    for (int x = 0; x < window.width_px; ++x) {
      if (row[x] != 0) points.push_back({x, y});
    }
  }
  return points;
}

std::vector<EdgePoint> points_near(const std::vector<EdgePoint>& points, const Line& line,
                                   double distance_px) {
  const double slope = std::tan(line.tilt_rad);
  std::vector<EdgePoint> near;
  near.reserve(points.size());
  for (const EdgePoint& p : points) {
    const double x_px = line.x_mean_px + slope * (p.y_px - line.y_mean_px);
    if (std::abs(p.x_px - x_px) <= distance_px) near.push_back(p);
  }
  return near;
}

int num_rows_of(const std::vector<EdgePoint>& points) {
  int rows = 0, previous = -1;
  for (const EdgePoint& p : points) {
    if (p.y_px != previous) ++rows;
    previous = p.y_px;
  }
  return rows;
}

}  // namespace

PixelRect edge_reading_area(const PixelRect& window, const PixelRect& picture) {
  // Half the median filter, one pixel for the gradient, one for non-maximum suppression.
  const int border = EdgeConfig::kMedianSize_px / 2 + 2;
  return intersection({window.x_px - border, window.y_px - border, window.width_px + 2 * border,
                       window.height_px + 2 * border},
                      picture);
}

EdgeMap edge_map(const PixelBlock& pixels, const EdgeConfig& config) {
  return edge_map(pixels, pixels.area, config);
}

EdgeMap edge_map(const PixelBlock& pixels, const PixelRect& area, const EdgeConfig& config) {
  EdgeMap map;
  map.area = area;
  cv::Mat grey;
  cv::cvtColor(view_of(pixels, area), grey, cv::COLOR_BGR2GRAY);
  cv::medianBlur(grey, grey, EdgeConfig::kMedianSize_px);
  map.edges = canny(grey.data, grey.cols, grey.rows, config.canny_low, config.canny_high);
  return map;
}

EdgeLine find_edge(const EdgeMap& map, const PixelRect& window, double expected_x_px,
                   const EdgeConfig& config) {
  if (window.empty() || !map.area.contains(window)) {
    throw std::invalid_argument("the window does not lie inside the edge map");
  }
  const double max_tilt_rad = config.max_tilt_deg * kRadPerDeg;
  const std::vector<EdgePoint> points = edge_points(map, window);
  std::optional<Line> line;
  double roc = 0.0;
  const auto min_points = static_cast<std::size_t>(config.min_points);
  if (config.fit == LineFit::kRegression) {
    if (points.size() >= min_points) line = fit_regression(points);
    if (line) roc = line->straightness;
  } else if (points.size() >= min_points) {
    std::vector<EdgePoint> inliers =
        points_of_best_line(points, window.width_px, window.height_px, expected_x_px - window.x_px,
                            kInlier_px, max_tilt_rad);
    if (inliers.size() >= min_points) line = fit_total_least_squares(inliers);
    if (line) {  // refit with the inliers of the fitted line instead of those of the search
      inliers = points_near(points, *line, kInlier_px);
      line = inliers.size() >= min_points ? fit_total_least_squares(inliers) : std::nullopt;
    }
    if (line) roc = line->straightness * num_rows_of(inliers) / window.height_px;
  }
  EdgeLine edge;
  if (!line || std::abs(line->tilt_rad) > max_tilt_rad) return edge;
  edge.found = true;
  edge.x_px = window.x_px + line->x_at(0.5 * (window.height_px - 1));
  edge.tilt_rad = line->tilt_rad;
  edge.roc = roc;
  return edge;
}

double parallel_confidence(const EdgeLine& left, const EdgeLine& right) {
  if (!left.found || !right.found) return 0.0;
  const double angle_deg = std::abs(left.tilt_rad - right.tilt_rad) / kRadPerDeg;
  return std::max(0.0, 1.0 - angle_deg / tuning::kParallelTolerance_deg);
}

}  // namespace orchard::vision
