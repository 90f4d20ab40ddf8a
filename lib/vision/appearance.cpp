// SPDX-License-Identifier: BSD-3-Clause
#include "vision/appearance.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <vector>

#include "vision/block_view.hpp"
#include "vision/tuning.hpp"

namespace orchard::vision {
namespace {

double linear_of(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

double srgb_of(double light) {
  return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055;
}

}  // namespace

std::array<std::uint8_t, 256> exposure_curve(double gain) {
  std::array<std::uint8_t, 256> curve{};
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const double light = std::min(1.0, gain * linear_of(static_cast<double>(i) / 255.0));
    curve[i] = static_cast<std::uint8_t>(std::lround(255.0 * srgb_of(light)));
  }
  return curve;
}

void normalise_exposure(PixelBlock& pixels) {
  std::array<std::size_t, 256> counts{};
  for (const std::uint8_t value : pixels.bgr) ++counts[value];
  double light = 0.0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    light += static_cast<double>(counts[i]) * linear_of(static_cast<double>(i) / 255.0);
  }
  light /= static_cast<double>(std::max<std::size_t>(1, pixels.bgr.size()));
  if (light >= kMeteredLight || light < tuning::kGreyLevelsMin * linear_of(1.0 / 255.0)) return;
  const auto curve = exposure_curve(kMeteredLight / light);
  for (std::uint8_t& value : pixels.bgr) value = curve[value];
}

PixelBlock exposed(const PixelBlock& pixels, double exposure_ev) {
  PixelBlock result = pixels;
  const auto curve = exposure_curve(std::exp2(exposure_ev));
  for (std::uint8_t& value : result.bgr) value = curve[value];
  return result;
}

std::vector<PixelBlock> learnt_exposures(PixelBlock pixels) {
  normalise_exposure(pixels);
  std::vector<PixelBlock> result;
  for (const double exposure_ev : kLearntExposures_ev) {
    result.push_back(exposed(pixels, exposure_ev));
  }
  return result;
}

namespace {

// physical: values outside these limits of an 8-bit pixel do not scale with the light.
constexpr int kDark = 4;
constexpr int kClipped = 250;

}  // namespace

std::optional<WindowLight> window_light(const PixelBlock& pixels, const PixelRect& window) {
  const cv::Mat view = view_of(pixels, window);
  std::array<double, 3> sums{};
  int num_used = 0;
  for (int y = 0; y < view.rows; ++y) {
    const auto* pixel = view.ptr<std::uint8_t>(y);
    for (int x = 0; x < view.cols; ++x, pixel += 3) {
      const auto [low, high] = std::minmax({pixel[0], pixel[1], pixel[2]});
      if (low < kDark || high > kClipped) continue;
      for (std::size_t c = 0; c < 3; ++c) sums[c] += pixel[c];
      ++num_used;
    }
  }
  if (4 * num_used < view.rows * view.cols || num_used == 0) return std::nullopt;
  const double green = std::log(sums[1] / num_used);
  return WindowLight{std::log(sums[0] / num_used) - green, std::log(sums[2] / num_used) - green,
                     green};
}

namespace {

constexpr int kChannels = 3;  // derived: blue, green, red

/// The source rows (or columns) covered by one row (or column) of the grid, and their weights; the
/// first and the last may be covered partly.
struct Cover {
  int first = 0;
  int last = 0;
  float first_weight = 0.0f;
  float weight = 0.0f;
  float last_weight = 0.0f;

  float operator()(int line) const {
    if (line == first) return first_weight;
    return line == last ? last_weight : weight;
  }
};

std::vector<Cover> covers_of(int num_lines, int num_cells) {
  const double lines_per_cell = static_cast<double>(num_lines) / num_cells;
  std::vector<Cover> covers(static_cast<std::size_t>(num_cells));
  for (int i = 0; i < num_cells; ++i) {
    const double from = i * lines_per_cell, to = from + lines_per_cell;
    Cover& cover = covers[static_cast<std::size_t>(i)];
    cover.first = static_cast<int>(from);
    cover.last = std::clamp(static_cast<int>(std::ceil(to - 1e-9)) - 1, cover.first, num_lines - 1);
    const auto fraction = [&](int line) {
      return static_cast<float>((std::min(to, line + 1.0) - std::max(from, line + 0.0)) /
                                lines_per_cell);
    };
    cover.first_weight = fraction(cover.first);
    cover.weight = static_cast<float>(1.0 / lines_per_cell);
    cover.last_weight = fraction(cover.last);
  }
  return covers;
}

}  // namespace

cv::Mat area_grid(const cv::Mat& pixels, int rows, int cols) {
  cv::Mat grid;
  if (pixels.rows < rows || pixels.cols < cols) {
    cv::Mat values;
    pixels.convertTo(values, CV_32FC3);
    cv::resize(values, grid, {cols, rows}, 0, 0, cv::INTER_AREA);
    return grid;
  }
  grid.create(rows, cols, CV_32FC3);
  const std::vector<Cover> row_covers = covers_of(pixels.rows, rows);
  const std::vector<Cover> col_covers = covers_of(pixels.cols, cols);
  const auto row_size = static_cast<std::size_t>(pixels.cols) * kChannels;
  std::vector<float> sums(row_size);
  for (int r = 0; r < rows; ++r) {
    const Cover& over_rows = row_covers[static_cast<std::size_t>(r)];
    std::fill(sums.begin(), sums.end(), 0.0f);
    for (int y = over_rows.first; y <= over_rows.last; ++y) {
      const float weight = over_rows(y);
      const auto* source = pixels.ptr<std::uint8_t>(y);
      for (std::size_t i = 0; i < row_size; ++i) sums[i] += weight * source[i];
    }
    auto* cell = grid.ptr<float>(r);
    for (const Cover& over_cols : col_covers) {
      float mean[kChannels] = {};
      for (int x = over_cols.first; x <= over_cols.last; ++x) {
        const float weight = over_cols(x);
        for (int c = 0; c < kChannels; ++c) mean[c] += weight * sums[kChannels * x + c];
      }
      for (const float value : mean) *cell++ = value;
    }
  }
  return grid;
}

namespace {

// derived: window and bands are resampled to this grid, so features and cost do not depend on
// range.
constexpr int kRows = 16;
constexpr int kCols = 8;  // of the window and of each band
constexpr int kAllCols = 3 * kCols;

/// A third of the grid.
enum Part { kLeft = 0, kWindow = 1, kRight = 2 };

/// One quantity over the grid, left band, window and right band side by side.
using Plane = Eigen::Array<float, kRows, kAllCols, Eigen::RowMajor>;

struct Planes {
  Plane brightness, red, blue;
};

/// Mean colour: logs of brightness, red over green and blue over green.
struct Tone {
  double brightness = 0.0, red = 0.0, blue = 0.0;
};

/// Every fourth row, starting with the first: a quarter of the cost suffices for a scene's mean.
cv::Mat thinned(const cv::Mat& pixels) {
  return {(pixels.rows + 3) / 4, pixels.cols, pixels.type(), pixels.data, 4 * pixels.step[0]};
}

std::uint16_t add(std::uint16_t sum, std::uint8_t value) {
  return static_cast<std::uint16_t>(sum + value);
}

/// Mean of each channel; bit-identical to cv::mean() in a tenth of its time.
std::array<double, 3> channel_means(const cv::Mat& pixels) {
  // derived: adds sixteen pixels at a time to as many columns of sums; sums of 128 rows fit into
  // 16 bits.
  constexpr std::size_t kLanes = 48;
  constexpr int kRowsAtOnce = 128;
  std::array<std::uint32_t, 3> sums{};
  const std::size_t row_bytes = 3u * static_cast<std::size_t>(pixels.cols);
  for (std::size_t x = 0; x < row_bytes; x += kLanes) {
    const std::size_t size = std::min(kLanes, row_bytes - x);
    for (int y0 = 0; y0 < pixels.rows; y0 += kRowsAtOnce) {
      std::array<std::uint16_t, kLanes> lanes{};
      for (int y = y0; y < std::min(y0 + kRowsAtOnce, pixels.rows); ++y) {
        const auto* row = pixels.ptr<std::uint8_t>(y) + x;
        if (size == kLanes) {
          for (std::size_t i = 0; i < kLanes; ++i) lanes[i] = add(lanes[i], row[i]);
        } else {
          for (std::size_t i = 0; i < size; ++i) lanes[i] = add(lanes[i], row[i]);
        }
      }
      for (std::size_t i = 0; i < kLanes; ++i) sums[i % 3] += lanes[i];
    }
  }
  const double fraction = 1.0 / (static_cast<double>(pixels.rows) * pixels.cols);
  return {sums[0] * fraction, sums[1] * fraction, sums[2] * fraction};
}

Tone tone_of(const cv::Mat& pixels) {
  const auto mean = channel_means(pixels);
  const double blue = mean[0] + 1.0, green = mean[1] + 1.0, red = mean[2] + 1.0;
  return {std::log(blue + green + red), std::log(red / green), std::log(blue / green)};
}

PixelRect band(const PixelRect& window, Part part) {
  PixelRect rect = window;
  rect.x_px += (part - 1) * window.width_px;
  return rect;
}

/// Resamples a rectangle of the block to one third of the grid.
cv::Mat grid_of(const PixelBlock& pixels, const PixelRect& rect) {
  return area_grid(view_of(pixels, rect), kRows, kCols);
}

/// Grids of left band, window and right band. A band of which less than half lies inside the block
/// is replaced by the mirrored other band, or by the mirrored window if both are missing.
std::array<cv::Mat, 3> grids_of(const PixelBlock& pixels, const PixelRect& window) {
  std::array<cv::Mat, 3> grids;
  grids[kWindow] = grid_of(pixels, window);
  for (const Part part : {kLeft, kRight}) {
    const PixelRect there = intersection(band(window, part), pixels.area);
    if (2 * there.width_px >= window.width_px && there.height_px == window.height_px) {
      grids[part] = grid_of(pixels, there);
    }
  }
  for (const Part part : {kLeft, kRight}) {
    if (!grids[part].empty()) continue;
    const cv::Mat& other = grids[2 - part].empty() ? grids[kWindow] : grids[2 - part];
    cv::flip(other, grids[part], 1);
  }
  return grids;
}

Planes planes_of(const std::array<cv::Mat, 3>& grids) {
  std::array<double, 3> sums{};
  for (const cv::Mat& grid : grids) {
    const cv::Scalar sum = cv::sum(grid);
    for (int c = 0; c < 3; ++c) sums[static_cast<std::size_t>(c)] += sum[c];
  }
  // Divide each channel by its mean over window and bands: exposure and white balance cancel.
  std::array<float, 3> gains{};
  for (std::size_t c = 0; c < 3; ++c) {
    gains[c] = static_cast<float>(kRows * kAllCols / std::max(sums[c], 1.0));
  }
  Plane blue, green, red;
  for (int row = 0; row < kRows; ++row) {
    for (int part = 0; part < 3; ++part) {
      const auto* pixel = grids[static_cast<std::size_t>(part)].ptr<float>(row);
      for (int col = part * kCols; col < (part + 1) * kCols; ++col, pixel += 3) {
        blue(row, col) = gains[0] * pixel[0];
        green(row, col) = gains[1] * pixel[1];
        red(row, col) = gains[2] * pixel[2];
      }
    }
  }
  const auto floor = static_cast<float>(tuning::kFloor);
  const Plane log_green = (green + floor).log();
  Planes planes;
  // Luma (ITU-R BT.601): JPEG codes it finer than any channel, and little of it is blue, which is
  // noisy where the light has little blue. By equal weights smooth things would look like bark.
  planes.brightness = (0.114f * blue + 0.587f * green + 0.299f * red + floor).log();
  planes.red = (red + floor).log() - log_green;
  planes.blue = (blue + floor).log() - log_green;
  return planes;
}

/// Statistics of one part of a plane.
struct PartStatistics {
  double mean = 0.0;
  double sd = 0.0;
  double in_columns = 0.0;  ///< fraction of the variance that lies between columns
  double rows_sd = 0.0;     ///< standard deviation of the row means
  double across = 0.0;      ///< mean absolute difference of neighbours in a row
  double along = 0.0;       ///< mean absolute difference of neighbours in a column
};

using Profile = Eigen::Array<float, 1, kAllCols>;

PartStatistics statistics_of(const Plane& plane, const Profile& profile, Part part) {
  PartStatistics s;
  const auto values = plane.middleCols<kCols>(part * kCols);
  const float mean = profile.segment<kCols>(part * kCols).mean();
  const Eigen::Array<float, kRows, kCols, Eigen::RowMajor> off = values - mean;
  const double variance = off.square().mean();
  s.mean = mean;
  s.sd = std::sqrt(variance);
  s.in_columns = (profile.segment<kCols>(part * kCols) - mean).square().mean() /
                 (variance + tuning::kSpreadFloor * tuning::kSpreadFloor);
  s.rows_sd = std::sqrt(off.rowwise().mean().square().mean());
  s.across = (values.rightCols<kCols - 1>() - values.leftCols<kCols - 1>()).abs().mean();
  s.along = (values.bottomRows<kRows - 1>() - values.topRows<kRows - 1>()).abs().mean();
  return s;
}

/// The steepest step of the column means near one side of the window.
struct Step {
  double brightness = 0.0;  ///< absolute
  double colour = 0.0;      ///< absolute, norm of red and blue, at its own steepest column
  double agreement = 0.0;   ///< fraction of rows whose step at the brightness column has its sign
};

double step_at(const Profile& profile, int col) {
  return 0.5 * (profile(col) + profile(col + 1) - profile(col - 1) - profile(col - 2));
}

Step step_about(int side, const Planes& planes, const std::array<Profile, 3>& profiles) {
  constexpr int kReach = 2;  // derived: the laser knows a side to a quarter of the window
  Step step;
  int steepest = side;
  for (int col = side - kReach; col <= side + kReach; ++col) {
    const double brightness = std::abs(step_at(profiles[0], col));
    const double colour = std::hypot(step_at(profiles[1], col), step_at(profiles[2], col));
    if (brightness > step.brightness) {
      step.brightness = brightness;
      steepest = col;
    }
    step.colour = std::max(step.colour, colour);
  }
  const double sign = step_at(profiles[0], steepest) < 0.0 ? -1.0 : 1.0;
  for (int row = 0; row < kRows; ++row) {
    const Plane& p = planes.brightness;
    const double rise =
        p(row, steepest) + p(row, steepest + 1) - p(row, steepest - 1) - p(row, steepest - 2);
    if (sign * rise > 0.0) step.agreement += 1.0 / kRows;
  }
  return step;
}

/// The 10 % and 90 % quantiles of a part.
struct Quantiles {
  double dark = 0.0, bright = 0.0;
};

Quantiles quantiles_of(const Plane& plane, Part part) {
  std::array<float, kRows * kCols> values;
  std::size_t n = 0;
  for (int row = 0; row < kRows; ++row) {
    for (int col = 0; col < kCols; ++col) values[n++] = plane(row, part * kCols + col);
  }
  const auto tenth = values.begin() + kRows * kCols / 10;
  const auto ninetieth = values.begin() + kRows * kCols * 9 / 10;
  std::nth_element(values.begin(), ninetieth, values.end());
  std::nth_element(values.begin(), tenth, ninetieth);
  return {*tenth, *ninetieth};
}

/// The smaller of two differences of the same sign; 0 if the signs differ.
double common(double a, double b) {
  if (a * b <= 0.0) return 0.0;
  return std::abs(a) < std::abs(b) ? a : b;
}

double log_of(double spread) { return std::log(spread + tuning::kSpreadFloor); }

}  // namespace

PixelRect appearance_reading_area(const PixelRect& window, const PixelRect& picture) {
  return intersection({picture.x_px, window.y_px, picture.width_px, window.height_px}, picture);
}

AppearanceFeatures appearance_features(const PixelBlock& pixels, const PixelRect& window) {
  const Planes planes = planes_of(grids_of(pixels, window));
  const std::array<const Plane*, 3> quantities{&planes.brightness, &planes.red, &planes.blue};
  std::array<Profile, 3> profiles;
  std::array<std::array<PartStatistics, 3>, 3> s;  // by quantity and part
  for (std::size_t q = 0; q < 3; ++q) {
    profiles[q] = quantities[q]->colwise().mean();
    for (const Part part : {kLeft, kWindow, kRight}) {
      s[q][part] = statistics_of(*quantities[q], profiles[q], part);
    }
  }
  AppearanceFeatures f{};
  std::size_t n = 0;
  for (const auto& q : s) f[n++] = q[kWindow].mean - 0.5 * (q[kLeft].mean + q[kRight].mean);
  for (const auto& q : s) {
    f[n++] = common(q[kWindow].mean - q[kLeft].mean, q[kWindow].mean - q[kRight].mean);
  }
  PixelRect strip = pixels.area;
  strip.y_px = window.y_px;
  strip.height_px = window.height_px;
  const Tone scene = tone_of(thinned(view_of(pixels, strip))),
             own = tone_of(view_of(pixels, window));
  f[n++] = own.brightness - scene.brightness;
  f[n++] = own.red - scene.red;
  f[n++] = own.blue - scene.blue;
  for (const auto& q : s) f[n++] = std::abs(q[kLeft].mean - q[kRight].mean);
  for (const auto& q : s) f[n++] = log_of(q[kWindow].sd);
  for (const auto& q : s) f[n++] = log_of(0.5 * (q[kLeft].sd + q[kRight].sd));
  const auto& light = s[0];
  f[n++] = log_of(light[kWindow].across);
  f[n++] = log_of(light[kWindow].along);
  f[n++] = log_of(0.5 * (light[kLeft].across + light[kRight].across));
  f[n++] = log_of(0.5 * (light[kLeft].along + light[kRight].along));
  f[n++] = light[kWindow].in_columns;
  f[n++] = s[2][kWindow].in_columns;
  f[n++] = 0.5 * (light[kLeft].in_columns + light[kRight].in_columns);
  const Step left = step_about(kCols, planes, profiles);
  const Step right = step_about(2 * kCols, planes, profiles);
  f[n++] = std::min(left.brightness, right.brightness);
  f[n++] = std::max(left.brightness, right.brightness);
  f[n++] = std::min(left.colour, right.colour);
  f[n++] = std::max(left.colour, right.colour);
  f[n++] = std::min(left.agreement, right.agreement);
  f[n++] = std::max(left.agreement, right.agreement);
  const auto mean_of = [&profiles](int first, int last) {
    return static_cast<double>(profiles[0].segment(first, last - first).mean());
  };
  f[n++] = mean_of(kCols + 2, kCols + 6) -
           0.5 * (mean_of(kCols, kCols + 2) + mean_of(kCols + 6, kCols + 8));
  f[n++] = std::abs(mean_of(kCols, kCols + 4) - mean_of(kCols + 4, kCols + 8));
  f[n++] =
      log_of(light[kWindow].rows_sd) - log_of(0.5 * (light[kLeft].rows_sd + light[kRight].rows_sd));
  const Quantiles w = quantiles_of(planes.brightness, kWindow);
  const Quantiles l = quantiles_of(planes.brightness, kLeft);
  const Quantiles r = quantiles_of(planes.brightness, kRight);
  f[n++] = w.bright - 0.5 * (l.bright + r.bright);
  f[n++] = w.dark - 0.5 * (l.dark + r.dark);
  return f;
}

double appearance_log_odds(const AppearanceFeatures& features, const AppearanceConfig& config) {
  if (!config.learnt() || !fits_features(config)) {
    throw std::invalid_argument("the appearance model was not learnt");
  }
  double log_odds = config.bias;
  for (std::size_t i = 0; i < features.size(); ++i) {
    const double z = (features[i] - config.mean[i]) / config.scale[i];
    log_odds += config.weights[i] * z;
    if (config.squares.empty()) continue;
    const double cut = std::clamp(z, -kAppearanceSquareReach, kAppearanceSquareReach);
    log_odds += config.squares[i] * (cut * cut - 1.0);
  }
  return log_odds;
}

double appearance_confidence(const AppearanceFeatures& features, const AppearanceConfig& config) {
  return 1.0 / (1.0 + std::exp(-appearance_log_odds(features, config)));
}

}  // namespace orchard::vision
