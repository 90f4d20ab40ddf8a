// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <memory>
#include <vector>

namespace orchard::io {

/// A window of a seekable stream in memory, moved on demand.
class FileWindow {
 public:
  /// The stream must be seekable.
  explicit FileWindow(std::unique_ptr<std::istream> stream);

  /// Bytes from the requested offset on: at least `wanted` of them, or all up to the end of the
  /// stream. Valid until the next call.
  struct View {
    const std::uint8_t* bytes = nullptr;
    std::size_t size = 0;
  };
  View at(std::uint64_t offset, std::size_t wanted);

  std::uint64_t size() const { return size_; }

 private:
  static constexpr std::size_t kReadBytes = std::size_t{1} << 20;

  std::unique_ptr<std::istream> stream_;
  std::uint64_t size_ = 0;
  std::uint64_t begin_ = 0;  ///< offset of buffer_[0]
  std::vector<std::uint8_t> buffer_;
  std::size_t filled_ = 0;
};

}  // namespace orchard::io
