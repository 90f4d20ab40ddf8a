// SPDX-License-Identifier: BSD-3-Clause
#include "vision/decode.hpp"

#include <csetjmp>
#include <cstddef>
#include <cstdio>  // jpeglib.h needs FILE before it
#include <cstring>
#include <vector>

#include <jpeglib.h>

namespace orchard::vision {
namespace {

// derived: fancy upsampling blends neighbouring chroma samples, and the codec treats the border of
// the decoded region as the border of the image. A chroma sample spans at most four pixels, so this
// margin keeps the requested pixels equal to those of a full decode.
constexpr int kMargin_px = 4;
// derived: no encoder writes more scans; each costs a pass.
constexpr int kMaxScans = 64;

struct Codec {
  jpeg_decompress_struct info;
  jpeg_error_mgr error;
  jpeg_progress_mgr progress;
  std::jmp_buf escape;
};

extern "C" {

[[noreturn]] void orchard_jpeg_fail(j_common_ptr info) {
  std::longjmp(static_cast<Codec*>(info->client_data)->escape, 1);
}

// A negative level is a warning about corrupt data, which the codec would otherwise conceal.
void orchard_jpeg_message(j_common_ptr info, int level) {
  if (level < 0) orchard_jpeg_fail(info);
}

void orchard_jpeg_silent(j_common_ptr) {}

void orchard_jpeg_progress(j_common_ptr info) {
  if (info->is_decompressor &&
      reinterpret_cast<j_decompress_ptr>(info)->input_scan_number > kMaxScans) {
    orchard_jpeg_fail(info);
  }
}

}  // extern "C"

/// Appends the pixels of `region` to `out`, which has room for them. `row` is a buffer for one
/// image row. Returns false when the bytes cannot be decoded. Local objects must be trivial,
/// because errors leave by longjmp.
bool read_region(Codec& codec, const std::uint8_t* data, std::size_t size, int width_px,
                 int height_px, const PixelRect& region, std::uint8_t* row,
                 std::vector<std::uint8_t>& out) {
  std::memset(&codec, 0, sizeof codec);
  jpeg_decompress_struct& info = codec.info;
  info.err = jpeg_std_error(&codec.error);
  codec.error.error_exit = orchard_jpeg_fail;
  codec.error.emit_message = orchard_jpeg_message;
  codec.error.output_message = orchard_jpeg_silent;
  info.client_data = &codec;
  if (setjmp(codec.escape) != 0) {
    jpeg_destroy_decompress(&info);
    return false;
  }
  jpeg_create_decompress(&info);
  codec.progress.progress_monitor = orchard_jpeg_progress;
  info.progress = &codec.progress;
  jpeg_mem_src(&info, data, size);
  jpeg_read_header(&info, TRUE);
  if (info.image_width != static_cast<JDIMENSION>(width_px) ||
      info.image_height != static_cast<JDIMENSION>(height_px) ||
      (info.num_components != 1 && info.num_components != 3)) {
    jpeg_destroy_decompress(&info);
    return false;
  }
  info.out_color_space = JCS_EXT_BGR;
  jpeg_start_decompress(&info);

  const int left_px = std::max(region.x_px - kMargin_px, 0);
  const int right_px = std::min(region.x_px + region.width_px + kMargin_px, width_px);
  JDIMENSION crop_x = static_cast<JDIMENSION>(left_px);
  JDIMENSION crop_width = static_cast<JDIMENSION>(right_px - left_px);
  if (right_px - left_px < width_px) jpeg_crop_scanline(&info, &crop_x, &crop_width);
  const std::uint8_t* first = row + 3 * (region.x_px - static_cast<int>(crop_x));

  const int skip = std::max(region.y_px - kMargin_px, 0);
  if (skip > 0) jpeg_skip_scanlines(&info, static_cast<JDIMENSION>(skip));
  const std::size_t row_bytes = 3u * static_cast<std::size_t>(region.width_px);
  while (static_cast<int>(info.output_scanline) < region.y_px + region.height_px) {
    const int y_px = static_cast<int>(info.output_scanline);
    JSAMPROW rows[1] = {row};
    if (jpeg_read_scanlines(&info, rows, 1) != 1) {
      jpeg_destroy_decompress(&info);
      return false;
    }
    if (y_px < region.y_px) continue;
    out.insert(out.end(), first, first + row_bytes);
  }
  jpeg_destroy_decompress(&info);
  return true;
}

}  // namespace

std::optional<PixelBlock> decode_jpeg_region(const std::uint8_t* data, std::size_t size,
                                             int width_px, int height_px, const PixelRect& region) {
  const PixelRect picture{0, 0, width_px, height_px};
  if (size == 0 || region.empty() || !picture.contains(region)) return std::nullopt;
  PixelBlock block;
  block.area = region;
  block.bgr.reserve(3u * static_cast<std::size_t>(region.width_px) *
                    static_cast<std::size_t>(region.height_px));
  std::vector<std::uint8_t> row(3u * static_cast<std::size_t>(width_px));
  Codec codec;
  if (!read_region(codec, data, size, width_px, height_px, region, row.data(), block.bgr)) {
    return std::nullopt;
  }
  return block;
}

namespace {

std::optional<PixelBlock> cut_bgr(const Image& image, const PixelRect& region) {
  const PixelRect picture{0, 0, image.width_px, image.height_px};
  const std::size_t stride = 3u * static_cast<std::size_t>(image.width_px);
  if (region.empty() || !picture.contains(region)) return std::nullopt;
  if (image.data.size() != stride * static_cast<std::size_t>(image.height_px)) return std::nullopt;
  PixelBlock block;
  block.area = region;
  const std::size_t row_bytes = 3u * static_cast<std::size_t>(region.width_px);
  block.bgr.resize(row_bytes * static_cast<std::size_t>(region.height_px));
  for (int y = 0; y < region.height_px; ++y) {
    std::memcpy(block.bgr.data() + row_bytes * static_cast<std::size_t>(y),
                image.data.data() + stride * static_cast<std::size_t>(region.y_px + y) +
                    3u * static_cast<std::size_t>(region.x_px),
                row_bytes);
  }
  return block;
}

}  // namespace

std::optional<PixelBlock> decode(const Image& image, const PixelRect& region) {
  if (image.width_px <= 0 || image.height_px <= 0) return std::nullopt;
  switch (image.encoding) {
    case Encoding::kJpeg:
      return decode_jpeg_region(image.data.data(), image.data.size(), image.width_px,
                                image.height_px, region);
    case Encoding::kBgr8:
      return cut_bgr(image, region);
    case Encoding::kGray8:
      break;
  }
  return std::nullopt;
}

namespace {

PixelBlock part_of(const PixelBlock& block, const PixelRect& region) {
  PixelBlock part;
  part.area = region;
  const std::size_t stride = 3u * static_cast<std::size_t>(block.area.width_px);
  const std::size_t row_bytes = 3u * static_cast<std::size_t>(region.width_px);
  part.bgr.reserve(row_bytes * static_cast<std::size_t>(region.height_px));
  const std::uint8_t* row = block.bgr.data() +
                            stride * static_cast<std::size_t>(region.y_px - block.area.y_px) +
                            3u * static_cast<std::size_t>(region.x_px - block.area.x_px);
  for (int y = 0; y < region.height_px; ++y, row += stride) {
    part.bgr.insert(part.bgr.end(), row, row + row_bytes);
  }
  return part;
}

}  // namespace

std::optional<PixelBlock> PictureReader::read(const PixelRect& region) {
  if (region.empty()) return std::nullopt;
  if (expected_.empty()) return decode(image_, region);
  if (!decoded_ || !decoded_->area.contains(region)) {
    decoded_ = decode(image_, bounding(region, expected_));
  }
  // If the larger area is damaged, this region may still decode on its own.
  return decoded_ ? part_of(*decoded_, region) : decode(image_, region);
}

}  // namespace orchard::vision
