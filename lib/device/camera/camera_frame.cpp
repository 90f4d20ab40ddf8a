// SPDX-License-Identifier: BSD-3-Clause
#include "device/camera/camera_frame.hpp"

#include <turbojpeg.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

namespace orchard::device {
namespace {

constexpr int kBestQuality = 90;
constexpr int kWorstQuality = 25;  // below, block artefacts of 8 pixels hide the edges of trunks
constexpr int kRise = 5;           // max increase from one picture to the next
constexpr int kMaxPixels_px = 16384;

using Handle = std::unique_ptr<void, int (*)(void*)>;
using Bytes = std::vector<std::uint8_t>;

/// Pixels ready for the JPEG encoder.
struct Planes {
  Bytes data;
  int width_px = 0;
  int height_px = 0;
  int subsampling = TJSAMP_422;
  int pixel_format = -1;  ///< TJPF_..., or -1: planes of Y, U and V
  int row_bytes = 0;
};

/// True if the bytes begin and end as a JPEG; padding may follow, as some cameras send it.
bool is_whole_jpeg(const Bytes& data) {
  if (data.size() < 4 || data[0] != 0xFF || data[1] != 0xD8) return false;
  std::size_t end = data.size();
  while (end > 4 && data[end - 1] == 0) --end;
  return data[end - 2] == 0xFF && data[end - 1] == 0xD9;
}

std::optional<Planes> decode_jpeg(const CameraFrame& frame) {
  const Handle decoder(tjInitDecompress(), tjDestroy);
  Planes planes;
  int colour_space = 0;
  const auto size = static_cast<unsigned long>(frame.data.size());
  if (!decoder ||
      tjDecompressHeader3(decoder.get(), frame.data.data(), size, &planes.width_px,
                          &planes.height_px, &planes.subsampling, &colour_space) != 0 ||
      planes.width_px != frame.width_px || planes.height_px != frame.height_px) {
    return std::nullopt;
  }
  planes.data.resize(tjBufSizeYUV2(planes.width_px, 1, planes.height_px, planes.subsampling));
  if (tjDecompressToYUV2(decoder.get(), frame.data.data(), size, planes.data.data(),
                         planes.width_px, 1, planes.height_px, 0) != 0) {
    return std::nullopt;
  }
  return planes;
}

Planes split_yuyv(const CameraFrame& frame) {
  Planes planes{{}, frame.width_px, frame.height_px, TJSAMP_422, -1, 0};
  const std::size_t num_pixels = static_cast<std::size_t>(frame.width_px) * frame.height_px;
  planes.data.resize(2 * num_pixels);
  std::uint8_t* y = planes.data.data();
  std::uint8_t* u = y + num_pixels;
  std::uint8_t* v = u + num_pixels / 2;
  for (int row = 0; row < frame.height_px; ++row) {
    const std::uint8_t* from = frame.data.data() + static_cast<std::size_t>(row) * frame.row_bytes;
    for (int column = 0; column < frame.width_px; column += 2, from += 4) {
      *y++ = from[0];
      *u++ = from[1];
      *y++ = from[2];
      *v++ = from[3];
    }
  }
  return planes;
}

/// Decodes or repacks the frame for compress(); none when its sizes contradict each other.
std::optional<Planes> planes_of(CameraFrame& frame) {
  if (frame.format == PixelFormat::kJpeg) return decode_jpeg(frame);
  const int pixel_bytes = frame.format == PixelFormat::kGrey   ? 1
                          : frame.format == PixelFormat::kYuyv ? 2
                                                               : 3;
  const bool is_possible = frame.width_px >= 1 && frame.height_px >= 1 &&
                           frame.width_px <= kMaxPixels_px && frame.height_px <= kMaxPixels_px &&
                           frame.row_bytes >= pixel_bytes * frame.width_px;
  if (!is_possible) return std::nullopt;
  const std::size_t least_bytes = static_cast<std::size_t>(frame.height_px - 1) * frame.row_bytes +
                                  static_cast<std::size_t>(pixel_bytes) * frame.width_px;
  if (frame.data.size() < least_bytes) return std::nullopt;
  if (frame.format == PixelFormat::kYuyv) {
    if (frame.width_px % 2 != 0) return std::nullopt;
    return split_yuyv(frame);
  }
  Planes planes{std::move(frame.data), frame.width_px, frame.height_px, TJSAMP_420, TJPF_BGR,
                frame.row_bytes};
  if (frame.format == PixelFormat::kRgb) planes.pixel_format = TJPF_RGB;
  if (frame.format == PixelFormat::kGrey) {
    planes.pixel_format = TJPF_GRAY;
    planes.subsampling = TJSAMP_GRAY;
  }
  return planes;
}

/// Compresses to a JPEG of this quality; empty when the library fails.
Bytes compress(const Planes& planes, int quality) {
  const Handle encoder(tjInitCompress(), tjDestroy);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  int result = -1;
  if (encoder && planes.pixel_format < 0) {
    result = tjCompressFromYUV(encoder.get(), planes.data.data(), planes.width_px, 1,
                               planes.height_px, planes.subsampling, &buffer, &size, quality, 0);
  } else if (encoder) {
    result = tjCompress2(encoder.get(), planes.data.data(), planes.width_px, planes.row_bytes,
                         planes.height_px, planes.pixel_format, &buffer, &size, planes.subsampling,
                         quality, 0);
  }
  const std::unique_ptr<unsigned char, void (*)(unsigned char*)> owner(buffer, tjFree);
  if (result != 0) return {};
  return Bytes(buffer, buffer + size);
}

}  // namespace

std::variant<vision::Image, NoPicture> PictureLimit::fit(CameraFrame frame) {
  vision::Image image;
  image.utime = frame.utime;
  image.width_px = frame.width_px;
  image.height_px = frame.height_px;
  image.encoding = vision::Encoding::kJpeg;
  if (frame.format == PixelFormat::kJpeg) {
    if (!is_whole_jpeg(frame.data)) return NoPicture{"an incomplete JPEG"};
    if (frame.data.size() <= max_bytes_) {
      image.data = std::move(frame.data);
      return image;
    }
  }
  const std::optional<Planes> planes = planes_of(frame);
  if (!planes) return NoPicture{"pixel data that does not match the size of the picture"};
  // Start near the quality of the last picture: scenes change slowly.
  int high = quality_ == 0 ? kBestQuality : std::min(kBestQuality, quality_ + kRise);
  image.data = compress(*planes, high);
  if (image.data.empty()) return NoPicture{"pixel data that cannot be compressed"};
  quality_ = high;
  if (image.data.size() <= max_bytes_) return image;
  int low = kWorstQuality;
  image.data.clear();
  for (--high; low <= high;) {
    const int middle = (low + high + 1) / 2;
    Bytes data = compress(*planes, middle);
    if (data.empty()) return NoPicture{"pixel data that cannot be compressed"};
    if (data.size() <= max_bytes_) {
      image.data = std::move(data);
      quality_ = middle;
      low = middle + 1;
    } else {
      high = middle - 1;
    }
  }
  if (image.data.empty()) {
    quality_ = kWorstQuality;
    return NoPicture{"larger than " + std::to_string(max_bytes_) + " bytes even with quality " +
                     std::to_string(kWorstQuality) +
                     ": choose a smaller picture size or a larger drivers.camera.max_bytes"};
  }
  return image;
}

}  // namespace orchard::device
