// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/windows/worst_windows.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "io/atomic_file.hpp"
#include "io/file_error.hpp"

namespace orchard::evaluation {
namespace {

constexpr int kTile_px = 140;
constexpr int kText_px = 16;
constexpr int kColumns = 8;
constexpr int kRowsPerKind = 3;
constexpr std::size_t kKept = kColumns * kRowsPerKind;

/// A square picture of the window, three times its width.
cv::Mat tile_of(const vision::PixelBlock& pixels, const vision::PixelRect& window) {
  const cv::Mat picture(pixels.area.height_px, pixels.area.width_px, CV_8UC3,
                        const_cast<std::uint8_t*>(pixels.bgr.data()));
  const int side = std::max(3 * window.width_px, window.height_px);
  const cv::Rect around(window.x_px + window.width_px / 2 - side / 2,
                        window.y_px + window.height_px / 2 - side / 2, side, side);
  const cv::Rect there = around & cv::Rect(0, 0, picture.cols, picture.rows);
  cv::Mat square(side, side, CV_8UC3, cv::Scalar(90, 90, 90));
  picture(there).copyTo(square(there - around.tl()));
  cv::Mat tile;
  cv::resize(square, tile, {kTile_px, kTile_px}, 0, 0, cv::INTER_LINEAR);
  const double scale = static_cast<double>(kTile_px) / side;
  const cv::Rect frame(cvRound(scale * (window.x_px - around.x)),
                       cvRound(scale * (window.y_px - around.y)), cvRound(scale * window.width_px),
                       cvRound(scale * window.height_px));
  cv::rectangle(tile, frame, {0, 255, 255});
  return tile;
}

}  // namespace

void WorstWindows::add(const std::string& picture, const vision::PixelBlock& pixels,
                       const calibration::LabelledWindow& labelled, double confidence) {
  Entry entry;
  entry.error = labelled.is_trunk ? 1.0 - confidence : confidence;
  std::vector<Entry>& worst = entries_[labelled.is_trunk ? 1 : 0];
  if (worst.size() == kKept && entry.error <= worst.back().error) return;
  entry.text = fmt::format("{:.12} {:.3f}", picture, confidence);
  const cv::Mat tile = tile_of(pixels, labelled.window);
  entry.bgr.assign(tile.datastart, tile.dataend);
  const auto place =
      std::upper_bound(worst.begin(), worst.end(), entry,
                       [](const Entry& a, const Entry& b) { return a.error > b.error; });
  worst.insert(place, std::move(entry));
  if (worst.size() > kKept) worst.pop_back();
}

void WorstWindows::write(const std::string& path) const {
  constexpr int kPitch_px = kTile_px + kText_px;
  cv::Mat sheet(2 * kRowsPerKind * kPitch_px, kColumns * kTile_px, CV_8UC3, cv::Scalar::all(255));
  for (std::size_t kind = 0; kind < entries_.size(); ++kind) {
    for (std::size_t i = 0; i < entries_[kind].size(); ++i) {
      const Entry& entry = entries_[kind][i];
      const int x_px = static_cast<int>(i % kColumns) * kTile_px;
      const int y_px = static_cast<int>(kind * kRowsPerKind + i / kColumns) * kPitch_px;
      const cv::Mat tile(kTile_px, kTile_px, CV_8UC3, const_cast<std::uint8_t*>(entry.bgr.data()));
      tile.copyTo(sheet(cv::Rect(x_px, y_px, kTile_px, kTile_px)));
      cv::putText(sheet, entry.text, {x_px + 2, y_px + kTile_px + kText_px - 4},
                  cv::FONT_HERSHEY_SIMPLEX, 0.42, {0, 0, 0}, 1, cv::LINE_AA);
    }
  }
  std::vector<std::uint8_t> png;
  if (!cv::imencode(".png", sheet, png))
    throw io::FileError(path + ": could not be encoded as PNG");
  io::write_file_atomically(path, {reinterpret_cast<const char*>(png.data()), png.size()});
}

}  // namespace orchard::evaluation
