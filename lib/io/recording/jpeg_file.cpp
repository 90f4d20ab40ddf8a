// SPDX-License-Identifier: BSD-3-Clause
#include "io/recording/jpeg_file.hpp"

#include <turbojpeg.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include "io/atomic_file.hpp"
#include "io/file_error.hpp"
#include "io/unpacking_budget.hpp"
#include "text/parse_number.hpp"

namespace orchard::io {

std::vector<std::uint8_t> read_picture_bytes(const std::string& path) {
  constexpr std::size_t kMaxBytes = std::size_t{16} << 20;
  const std::string bytes = read_file(path, kMaxBytes, "remove or replace this picture");
  if (bytes.empty()) throw FileError(path + ": 0 bytes; remove or replace it");
  return {bytes.begin(), bytes.end()};
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
  const std::uint64_t num_bytes = std::uint64_t{3} * static_cast<unsigned>(image.width_px) *
                                  static_cast<unsigned>(image.height_px);
  if (!is_plausibly_packed(size, num_bytes)) return std::nullopt;
  image.data.assign(data, data + size);
  return image;
}

std::vector<TimedJpeg> list_jpegs(const std::string& folder, OtherFiles others) {
  std::error_code error;
  std::vector<TimedJpeg> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const bool is_jpeg = entry.path().extension() == ".jpg";
    if (!is_jpeg && others == OtherFiles::kSkip) continue;
    TimedJpeg file;
    file.path = entry.path().string();
    file.utime = parse_number<std::int64_t>(entry.path().stem().string()).value_or(-1);
    if (!is_jpeg || file.utime < 0) {
      throw FileError(file.path +
                      ": the name of a picture must be <utime_us>.jpg; rename or remove it");
    }
    files.push_back(std::move(file));
  }
  std::sort(files.begin(), files.end(),
            [](const TimedJpeg& a, const TimedJpeg& b) { return a.utime < b.utime; });
  const auto other =
      std::adjacent_find(files.begin(), files.end(),
                         [](const TimedJpeg& a, const TimedJpeg& b) { return a.utime == b.utime; });
  if (other != files.end())
    throw FileError(other->path + ": another picture has the same time; remove one");
  return files;
}

}  // namespace orchard::io
