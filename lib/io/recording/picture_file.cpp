// SPDX-License-Identifier: BSD-3-Clause
#include "io/recording/picture_file.hpp"

#include <cctype>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>

#include "io/file_error.hpp"
#include "io/recording/jpeg_file.hpp"
#include "io/unpacking_budget.hpp"

namespace orchard::io {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxSide_px = 8192;

bool is_png(const std::uint8_t* data, std::size_t size) {
  constexpr std::uint8_t kStart[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  return size > 24 && std::memcmp(data, kStart, sizeof(kStart)) == 0;
}

std::string ending_of(const fs::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

}  // namespace

std::optional<vision::Image> png_image(const std::uint8_t* data, std::size_t size,
                                       PngColours colours) {
  if (!is_png(data, size)) return std::nullopt;
  const auto number = [data](std::size_t i) {
    return std::uint32_t{data[i]} << 24 | std::uint32_t{data[i + 1]} << 16 |
           std::uint32_t{data[i + 2]} << 8 | std::uint32_t{data[i + 3]};
  };
  for (const std::uint32_t side_px : {number(16), number(20)}) {
    if (side_px == 0 || side_px > kMaxSide_px) return std::nullopt;
  }
  constexpr std::size_t kBitsAt = 24, kColoursAt = 25;  // physical: PNG specification, 11.2.2
  if (colours == PngColours::kAsTheyAre && data[kBitsAt] > 8) return std::nullopt;
  const bool is_grey =
      colours == PngColours::kGrey || (colours == PngColours::kAsTheyAre && data[kColoursAt] == 0);
  const std::uint64_t num_bytes = (is_grey ? 1u : 3u) * std::uint64_t{number(16)} * number(20);
  if (!is_plausibly_packed(size, num_bytes)) return std::nullopt;
  const int mode = colours == PngColours::kGrey ? cv::IMREAD_GRAYSCALE : cv::IMREAD_ANYCOLOR;
  const cv::Mat bytes(1, static_cast<int>(size), CV_8UC1,
                      const_cast<std::uint8_t*>(data));  // OpenCV has no const matrix
  // Into a matrix of its own: OpenCV gives back one that it was given, also of half a picture.
  cv::Mat pixels;
  try {
    pixels = cv::imdecode(bytes, mode | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
  }
  if (pixels.empty()) return std::nullopt;
  vision::Image image;
  image.width_px = pixels.cols;
  image.height_px = pixels.rows;
  image.encoding = pixels.channels() == 1 ? vision::Encoding::kGray8 : vision::Encoding::kBgr8;
  image.data.assign(pixels.datastart, pixels.dataend);
  return image;
}

vision::Image read_picture_file(const std::string& path) {
  const std::vector<std::uint8_t> bytes = read_picture_bytes(path);
  if (is_png(bytes.data(), bytes.size())) {
    if (auto image = png_image(bytes.data(), bytes.size(), PngColours::kGrey)) return *image;
    throw FileError(
        path +
        ": is a damaged PNG picture, has more than 8192 pixels per side, or far more pixels "
        "than bytes; remove or replace it");
  }
  if (auto image = jpeg_image(bytes.data(), bytes.size())) return *image;
  throw FileError(path + ": is neither a JPEG nor a PNG picture; remove or convert it");
}

bool has_picture_name(const std::string& path) {
  const std::string ending = ending_of(path);
  return ending == ".jpg" || ending == ".jpeg" || ending == ".png";
}

}  // namespace orchard::io
