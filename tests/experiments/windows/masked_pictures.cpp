// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/windows/masked_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <random>
#include <sstream>

#include "io/file_error.hpp"
#include "io/recording/jpeg_file.hpp"
#include "io/recording/picture_file.hpp"
#include "vision/decode.hpp"

namespace orchard::evaluation {
namespace {

constexpr int kPerClass = 60;       // windows on trunks, and elsewhere
constexpr double kAspectMin = 1.0;  // height to width
constexpr double kAspectMax = 3.0;  //
constexpr double kScatter = 0.15;   // max error of position and width, of the trunk's width
constexpr int kMinWidth_px = 6;     // narrower parts of a trunk are left out
constexpr double kMinTrunkFraction = 0.6;
constexpr int kTries = 50;          // in a row for a window without trunk
constexpr int kRowsPerWindow = 20;  // for a row with a trunk
constexpr int kMinRed = 64;         // darker pixels are background

/// Mask of a picture: 1 for pixels on a trunk, otherwise 0; rows top-down, no padding.
struct TrunkMask {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint8_t> trunk;
};

class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : engine_(seed) {}
  double operator()(double low, double high) {  // identical with every standard library
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1.0p-53;
  }
  int index(int size) {
    return std::min(static_cast<int>((*this)(0.0, static_cast<double>(size))), size - 1);
  }

 private:
  std::mt19937_64 engine_;
};

/// Counts the trunk pixels of any window in constant time.
class TrunkCounts {
 public:
  explicit TrunkCounts(const TrunkMask& mask) {
    const cv::Mat trunk(mask.height_px, mask.width_px, CV_8UC1,
                        const_cast<std::uint8_t*>(mask.trunk.data()));
    cv::integral(cv::min(trunk, 1), sums_, CV_32S);
  }
  std::int64_t in(const vision::PixelRect& w) const {
    const int right = w.x_px + w.width_px, bottom = w.y_px + w.height_px;
    return std::int64_t{at(right, bottom)} - at(w.x_px, bottom) - at(right, w.y_px) +
           at(w.x_px, w.y_px);
  }

 private:
  int at(int x, int y) const { return sums_.at<int>(y, x); }
  cv::Mat sums_;
};

/// Consecutive trunk columns in a row: the first and their number.
struct Run {
  int first_px = 0;
  int width_px = 0;
};

Run widest_run(const TrunkMask& mask, int row) {
  Run widest, run;
  for (int x = 0; x < mask.width_px; ++x) {
    const auto i = static_cast<std::size_t>(row) * static_cast<std::size_t>(mask.width_px) +
                   static_cast<std::size_t>(x);
    run = mask.trunk[i] == 0 ? Run{x + 1, 0} : Run{run.first_px, run.width_px + 1};
    if (run.width_px > widest.width_px) widest = run;
  }
  return widest;
}

/// A window on the run; none if it would leave the image or contain too little trunk.
std::optional<vision::PixelRect> window_on(const Run& run, int row, const TrunkMask& mask,
                                           const TrunkCounts& counts, Uniform& uniform) {
  const double scatter = kScatter * run.width_px;
  const double centre_px = run.first_px + 0.5 * run.width_px + uniform(-scatter, scatter);
  const double width_px = run.width_px * uniform(1.0 - kScatter, 1.0 + kScatter);
  vision::PixelRect window;
  window.width_px = static_cast<int>(std::lround(width_px));
  const double aspect = uniform(kAspectMin, kAspectMax);
  window.height_px = static_cast<int>(std::lround(aspect * run.width_px));
  window.x_px = static_cast<int>(std::lround(centre_px - 0.5 * window.width_px));
  window.y_px = row - window.height_px / 2;
  if (window.empty() || !vision::PixelRect{0, 0, mask.width_px, mask.height_px}.contains(window)) {
    return std::nullopt;
  }
  const double widest = std::min<double>(window.width_px, run.width_px);
  const double fraction = static_cast<double>(counts.in(window)) / (widest * window.height_px);
  return fraction >= kMinTrunkFraction ? std::optional(window) : std::nullopt;
}

std::optional<vision::PixelRect> window_elsewhere(vision::PixelRect window, const TrunkMask& mask,
                                                  const TrunkCounts& counts, Uniform& uniform) {
  for (int i = 0; i < kTries; ++i) {
    window.x_px = uniform.index(mask.width_px - window.width_px + 1);
    if (counts.in(window) == 0) return window;
  }
  return std::nullopt;
}

std::vector<LabelledWindow> sample_windows(const TrunkMask& mask, std::uint64_t seed) {
  std::vector<int> rows;
  std::vector<Run> runs;
  for (int row = 0; row < mask.height_px; ++row) {
    runs.push_back(widest_run(mask, row));
    if (runs.back().width_px >= kMinWidth_px) rows.push_back(row);
  }
  std::vector<LabelledWindow> windows;
  if (rows.empty()) return windows;
  const TrunkCounts counts(mask);
  Uniform uniform(seed);
  int found = 0;
  for (int i = 0; i < kRowsPerWindow * kPerClass && found < kPerClass; ++i) {
    const int row = rows[static_cast<std::size_t>(uniform.index(static_cast<int>(rows.size())))];
    const auto on = window_on(runs[static_cast<std::size_t>(row)], row, mask, counts, uniform);
    if (!on) continue;
    const auto elsewhere = window_elsewhere(*on, mask, counts, uniform);
    if (!elsewhere) continue;
    windows.push_back({*on, true});
    windows.push_back({*elsewhere, false});
    ++found;
  }
  return windows;
}

/// Of a picture's name (FNV-1a), so that its windows do not depend on the other pictures.
std::uint64_t seed_of(const std::string& name) {
  std::uint64_t hash = 1469598103934665603ull;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  return hash + 1;
}

bool is_among(const std::string& name, const std::string& only) {
  std::istringstream ranges(only);
  for (std::string range; std::getline(ranges, range, ',');) {
    const int first = std::stoi(range), last = std::stoi(range.substr(range.find('-') + 1));
    if (first <= std::stoi(name) && std::stoi(name) <= last) return true;
  }
  return only.empty();
}

vision::PixelBlock read_pixels(const std::string& path) {
  const std::vector<std::uint8_t> bytes = io::read_picture_bytes(path);
  if (auto png = io::png_image(bytes.data(), bytes.size(), io::PngColours::kAsTheyAre)) {
    return {{0, 0, png->width_px, png->height_px}, std::move(png->data)};
  }
  const vision::Image image = io::read_picture_file(path);
  auto pixels = vision::decode(image, {0, 0, image.width_px, image.height_px});
  if (!pixels) throw io::FileError(path + ": is not a complete picture");
  return std::move(*pixels);
}

TrunkMask trunk_mask(const vision::PixelBlock& pixels) {
  TrunkMask mask{pixels.area.width_px, pixels.area.height_px, {}};
  for (std::size_t i = 0; i + 2 < pixels.bgr.size(); i += 3) {
    const int blue = pixels.bgr[i], green = pixels.bgr[i + 1], red = pixels.bgr[i + 2];
    mask.trunk.push_back(red >= kMinRed && red >= 2 * green && red >= 2 * blue ? 1 : 0);
  }
  return mask;
}

}  // namespace

std::vector<PictureWindows> read_masked_pictures(const std::string& picture_folder,
                                                 const std::string& mask_folder,
                                                 const std::string& only) {
  namespace fs = std::filesystem;
  std::map<std::string, std::string> masks, paths;
  for (const auto& entry : fs::directory_iterator(mask_folder)) {
    masks[entry.path().stem().string()] = entry.path().string();
  }
  for (const auto& entry : fs::directory_iterator(picture_folder)) {
    const std::string name = entry.path().stem().string();
    if (is_among(name, only)) paths[name] = entry.path().string();
  }
  std::vector<PictureWindows> pictures;
  std::map<std::int64_t, int> group_of_size;
  for (const auto& [name, path] : paths) {
    const auto mask_path = masks.find(name);
    if (mask_path == masks.end()) continue;
    const TrunkMask mask = trunk_mask(read_pixels(mask_path->second));
    PictureWindows picture{read_pixels(path), 0, {}};
    if (mask.width_px != picture.pixels.area.width_px ||
        mask.height_px != picture.pixels.area.height_px) {
      throw io::FileError(mask_path->second + ": is of another size than its picture");
    }
    picture.windows = sample_windows(mask, seed_of(name));
    if (picture.windows.empty()) continue;
    const auto size = std::count(mask.trunk.begin(), mask.trunk.end(), 1);
    picture.group =
        group_of_size.emplace(size, static_cast<int>(group_of_size.size())).first->second;
    pictures.push_back(std::move(picture));
  }
  if (pictures.empty()) throw io::FileError(picture_folder + ": no picture could be used");
  return pictures;
}

}  // namespace orchard::evaluation
