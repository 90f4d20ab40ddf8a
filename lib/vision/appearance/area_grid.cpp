// SPDX-License-Identifier: BSD-3-Clause
#include "vision/appearance/area_grid.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace orchard::vision {
namespace {

constexpr int kChannels = 3;

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

}  // namespace orchard::vision
