// SPDX-License-Identifier: BSD-3-Clause
#include "io/recording/masked_pictures.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>
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
#include "vision/decode.hpp"

namespace orchard::io {
namespace {

namespace fs = std::filesystem;

constexpr int kMaskMaxSide_px = 8192;
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
    const std::string ending = ending_of(i->path());
    if (ending != ".jpg" && ending != ".jpeg" && ending != ".png") continue;
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
  if (image.width_px > kMaskMaxSide_px || image.height_px > kMaskMaxSide_px)
    refuse_as_unreadable(path);
  auto pixels = vision::decode(image, {0, 0, image.width_px, image.height_px});
  if (!pixels) refuse_as_unreadable(path);
  return std::move(*pixels);
}

vision::PixelBlock read_png(const std::string& path) {
  const std::vector<std::uint8_t> bytes = read_picture_bytes(path);
  cv::Mat picture;
  try {
    picture = cv::imdecode(bytes, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {  // larger than OpenCV supports
    picture.release();
  }
  if (picture.empty() || picture.cols > kMaskMaxSide_px || picture.rows > kMaskMaxSide_px) {
    refuse_as_unreadable(path);
  }
  vision::PixelBlock pixels;
  pixels.area = {0, 0, picture.cols, picture.rows};
  pixels.bgr.assign(picture.datastart, picture.dataend);
  return pixels;
}

vision::PixelBlock read_picture(const std::string& path) {
  return ending_of(path) == ".png" ? read_png(path) : read_jpeg(path);
}

std::string size_text(const vision::PixelRect& area) {
  return std::to_string(area.width_px) + " x " + std::to_string(area.height_px);
}

}  // namespace

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
