// SPDX-License-Identifier: BSD-3-Clause
#include "io/recording/picture_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "io/file_error.hpp"
#include "io/recording/jpeg_file.hpp"

namespace orchard::io {
namespace {

constexpr std::uint32_t kMaxSide_px = 8192;
constexpr std::array<std::uint8_t, 8> kPngStart{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
constexpr std::size_t kPngHeaderBytes = 24;  // up to the height

std::uint32_t big_endian(const std::uint8_t* bytes) {
  return std::uint32_t{bytes[0]} << 24 | std::uint32_t{bytes[1]} << 16 |
         std::uint32_t{bytes[2]} << 8 | bytes[3];
}

vision::Image decode_png(const std::string& path, const std::vector<std::uint8_t>& bytes) {
  // check the size before allocating
  const std::uint32_t width_px = big_endian(&bytes[16]), height_px = big_endian(&bytes[20]);
  if (width_px == 0 || height_px == 0 || width_px > kMaxSide_px || height_px > kMaxSide_px) {
    throw FileError(path + ": its PNG header states " + std::to_string(width_px) + " x " +
                    std::to_string(height_px) +
                    " pixels, but only 1 to 8192 per side are supported");
  }
  cv::Mat grey;
  try {
    grey = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
  }
  if (grey.empty()) throw FileError(path + ": is a damaged PNG picture; remove or replace it");
  vision::Image image;
  image.width_px = grey.cols;
  image.height_px = grey.rows;
  image.encoding = vision::Encoding::kGray8;
  for (int row = 0; row < grey.rows; ++row) {
    image.data.insert(image.data.end(), grey.ptr(row), grey.ptr(row) + grey.cols);
  }
  return image;
}

}  // namespace

vision::Image read_picture_file(const std::string& path) {
  const std::vector<std::uint8_t> bytes = read_picture_bytes(path);
  if (bytes.size() > kPngHeaderBytes) {
    if (std::equal(kPngStart.begin(), kPngStart.end(), bytes.begin()))
      return decode_png(path, bytes);
    if (bytes[0] == 0xff && bytes[1] == 0xd8) return read_jpeg_file(path);
  }
  throw FileError(path + ": is neither a JPEG nor a PNG picture; remove or convert it");
}

bool has_picture_name(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending == ".jpg" || ending == ".jpeg" || ending == ".png";
}

}  // namespace orchard::io
