// SPDX-License-Identifier: BSD-3-Clause
#include "io/recording/picture_file.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "io/file_error.hpp"
#include "io/recording/jpeg_file.hpp"
#include "io/unpacking_budget.hpp"
#include "vision/decode.hpp"

namespace orchard::io {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxSide_px = 8192;

bool is_png(const std::uint8_t* data, std::size_t size) {
  constexpr std::uint8_t kStart[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  return size > 24 && std::memcmp(data, kStart, sizeof(kStart)) == 0;
}

constexpr int kMinRed = 64;  // darker pixels are background

using Range = std::pair<long, long>;  // first and last number

std::optional<long> number_of(std::string_view text) {
  long number = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool good = result.ec == std::errc() && result.ptr == text.data() + text.size();
  return good && number >= 0 ? std::optional(number) : std::nullopt;
}

std::vector<Range> ranges_of(const std::string& only) {
  std::vector<Range> ranges;
  for (std::size_t begin = 0; begin <= only.size();) {
    const std::size_t end = std::min(only.find(',', begin), only.size());
    const std::string_view part = std::string_view(only).substr(begin, end - begin);
    const std::size_t dash = part.find('-');
    const auto first = number_of(part.substr(0, dash));
    const auto last = dash == std::string_view::npos ? first : number_of(part.substr(dash + 1));
    if (!first || !last || *last < *first) {
      throw FileError("--only " + only + ": must be picture numbers such as 000-019 or 0-19,30");
    }
    ranges.emplace_back(*first, *last);
    begin = end + 1;
  }
  return ranges;
}

bool is_in(const std::string& name, const std::vector<Range>& ranges) {
  const auto number = number_of(name);
  return number && std::any_of(ranges.begin(), ranges.end(), [&number](const Range& range) {
           return *number >= range.first && *number <= range.second;
         });
}

std::string ending_of(const fs::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

/// Images in a folder: name without extension -> path.
std::map<std::string, std::string> pictures_in(const std::string& folder) {
  std::map<std::string, std::string> pictures;
  std::error_code error;
  for (fs::directory_iterator i(folder, error), end; !error && i != end; i.increment(error)) {
    if (!has_picture_name(i->path().string())) continue;
    const auto [entry, is_new] = pictures.emplace(i->path().stem().string(), i->path().string());
    if (!is_new) entry->second = std::min(entry->second, i->path().string());
  }
  if (error) throw FileError(folder + ": cannot be read (" + error.message() + ")");
  if (pictures.empty()) {
    throw FileError(folder +
                    ": has no picture (.jpg, .jpeg or .png); give the folder of the pictures");
  }
  return pictures;
}

[[noreturn]] void refuse_as_unreadable(const std::string& path) {
  throw FileError(path + ": is not a complete picture; remove or replace it");
}

/// Reads a JPEG with our decoder, which rejects truncated files; OpenCV returns a partial image.
vision::PixelBlock read_jpeg(const std::string& path) {
  const vision::Image image = read_jpeg_file(path);
  if (image.width_px > kMaxSide_px || image.height_px > kMaxSide_px) refuse_as_unreadable(path);
  auto pixels = vision::decode(image, {0, 0, image.width_px, image.height_px});
  if (!pixels) refuse_as_unreadable(path);
  return std::move(*pixels);
}

vision::PixelBlock read_png(const std::string& path) {
  const std::vector<std::uint8_t> bytes = read_picture_bytes(path);
  auto image = png_image(bytes.data(), bytes.size(), PngColours::kBgr);
  if (!image) refuse_as_unreadable(path);
  return {{0, 0, image->width_px, image->height_px}, std::move(image->data)};
}

vision::PixelBlock read_picture(const std::string& path) {
  return ending_of(path) == ".png" ? read_png(path) : read_jpeg(path);
}

std::string size_text(const vision::PixelRect& area) {
  return std::to_string(area.width_px) + " x " + std::to_string(area.height_px);
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
  const int mode = colours == PngColours::kGrey  ? cv::IMREAD_GRAYSCALE
                   : colours == PngColours::kBgr ? cv::IMREAD_COLOR
                                                 : cv::IMREAD_ANYCOLOR;
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

MaskedPictureList list_masked_pictures(const std::string& picture_folder,
                                       const std::string& mask_folder, const std::string& only) {
  const std::vector<Range> ranges = only.empty() ? std::vector<Range>{} : ranges_of(only);
  const auto pictures = pictures_in(picture_folder);
  const auto masks = pictures_in(mask_folder);
  MaskedPictureList list;
  for (const auto& [name, path] : pictures) {
    if (!only.empty() && !is_in(name, ranges)) continue;
    const auto mask = masks.find(name);
    if (mask == masks.end()) {
      list.without_mask.push_back(name);
    } else {
      list.pictures.push_back({name, path, mask->second});
    }
  }
  if (list.pictures.empty() && list.without_mask.empty()) {
    throw FileError("--only " + only + ": no picture of " + picture_folder +
                    " has such a number; the numbers go from " + pictures.begin()->first + " to " +
                    pictures.rbegin()->first);
  }
  if (list.pictures.empty()) {
    throw FileError(mask_folder + ": has no mask with the name of a picture, such as " +
                    list.without_mask.front() + "; give the folder of the masks");
  }
  return list;
}

MaskedPicture read_masked_picture(const MaskedPicturePaths& paths) {
  MaskedPicture result;
  result.pixels = read_picture(paths.picture);
  const vision::PixelBlock mask = read_picture(paths.mask);
  const vision::PixelRect &size = result.pixels.area, &mask_size = mask.area;
  if (size.width_px != mask_size.width_px || size.height_px != mask_size.height_px) {
    throw FileError(paths.mask + ": is " + size_text(mask_size) + " pixels, but its picture " +
                    size_text(size) + "; a mask must have the size of its picture");
  }
  result.mask.width_px = size.width_px;
  result.mask.height_px = size.height_px;
  result.mask.trunk.reserve(mask.bgr.size() / 3);
  for (std::size_t i = 0; i + 2 < mask.bgr.size(); i += 3) {
    const int blue = mask.bgr[i], green = mask.bgr[i + 1], red = mask.bgr[i + 2];
    const bool is_trunk = red >= kMinRed && red >= 2 * green && red >= 2 * blue;
    result.mask.trunk.push_back(is_trunk ? 1 : 0);
  }
  if (std::count(result.mask.trunk.begin(), result.mask.trunk.end(), 1) == 0) {
    throw FileError(paths.mask + ": has no red pixel, so no trunk is marked");
  }
  return result;
}

}  // namespace orchard::io
