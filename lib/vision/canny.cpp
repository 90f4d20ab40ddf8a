// SPDX-License-Identifier: BSD-3-Clause
#include "vision/canny.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <opencv2/core/hal/intrin.hpp>

namespace orchard::vision {
namespace {

using Row = std::vector<std::int16_t>;

constexpr int kLanes = cv::v_int16x8::nlanes;
/// Padding columns on each side of a row, so that every pixel has neighbours.
constexpr int kBorder_px = kLanes;
/// tan(22.5 deg) x 2^15: limit between horizontal and diagonal gradients, as in OpenCV.
constexpr std::int16_t kTan22 = 13573;
constexpr std::int16_t kMaxGradient = 2 * 4 * 255;

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
  constexpr std::uint8_t kThree[] = {kWeak, kWeak, kWeak, 0};  // independent of byte order
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

}  // namespace orchard::vision
