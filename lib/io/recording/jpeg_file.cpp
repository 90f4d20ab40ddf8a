// SPDX-License-Identifier: BSD-3-Clause
#include "io/recording/jpeg_file.hpp"

#include <turbojpeg.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <utility>
#include <vector>

#include "io/file_error.hpp"

namespace orchard::io {

std::vector<std::uint8_t> read_picture_bytes(const std::string& path) {
  constexpr std::uintmax_t kMaxBytes = std::uintmax_t{16} << 20;
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw FileError(path + ": cannot be read (" + error.message() + ")");
  if (size == 0 || size > kMaxBytes) {
    throw FileError(path + ": " + std::to_string(size) +
                    " bytes; a picture must have 1 byte to 16 MB; remove or replace it");
  }
  std::vector<std::uint8_t> data(static_cast<std::size_t>(size));
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(data.data()), static_cast<std::streamsize>(size));
  if (!file) throw FileError(path + ": could not be read completely");
  return data;
}

vision::Image read_jpeg_file(const std::string& path) {
  const std::vector<std::uint8_t> data = read_picture_bytes(path);
  auto image = jpeg_image(data.data(), data.size());
  if (!image) throw FileError(path + ": is not a JPEG picture; remove or replace it");
  return std::move(*image);
}

std::optional<vision::Image> jpeg_image(const std::uint8_t* data, std::size_t size) {
  vision::Image image;
  image.encoding = vision::Encoding::kJpeg;
  const std::unique_ptr<void, int (*)(void*)> decoder(tjInitDecompress(), tjDestroy);
  int subsampling = 0, colour_space = 0;
  const bool is_jpeg =
      decoder && size > 0 &&
      tjDecompressHeader3(decoder.get(), data, static_cast<unsigned long>(size), &image.width_px,
                          &image.height_px, &subsampling, &colour_space) == 0;
  if (!is_jpeg || image.width_px <= 0 || image.height_px <= 0) return std::nullopt;
  image.data.assign(data, data + size);
  return image;
}

}  // namespace orchard::io
