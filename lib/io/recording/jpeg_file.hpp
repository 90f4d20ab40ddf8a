// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vision/image.hpp"

namespace orchard::io {

/// Reads all of a picture's file. Throws FileError when it cannot be read, is empty or over 16 MB.
std::vector<std::uint8_t> read_picture_bytes(const std::string& path);

/// Reads a JPEG file without decoding it, with the size from its header; utime and seq are left 0.
/// Throws FileError when it cannot be read, is over 16 MB or is not a JPEG.
vision::Image read_jpeg_file(const std::string& path);

/// Wraps JPEG bytes in an image, with the size from its header; utime and seq are left 0. None when
/// the bytes are not a JPEG.
std::optional<vision::Image> jpeg_image(const std::uint8_t* data, std::size_t size);

/// A picture that is named after its time.
struct TimedJpeg {
  std::int64_t utime = 0;
  std::string path;
};
enum class OtherFiles { kRefuse, kSkip };

/// Lists FOLDER/<utime_us>.jpg in order of time; empty if there is no such folder. Throws FileError
/// for a JPEG of another name, for two of one time, and for other files unless they are skipped.
std::vector<TimedJpeg> list_jpegs(const std::string& folder, OtherFiles others);

}  // namespace orchard::io
