// SPDX-License-Identifier: BSD-3-Clause
#include "io/log/file_window.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace orchard::io {

FileWindow::FileWindow(std::unique_ptr<std::istream> stream) : stream_(std::move(stream)) {
  stream_->seekg(0, std::ios::end);
  const std::streamoff end = stream_->tellg();
  size_ = end > 0 ? static_cast<std::uint64_t>(end) : 0;
}

FileWindow::View FileWindow::at(std::uint64_t offset, std::size_t wanted) {
  if (offset >= size_) return {};
  wanted = static_cast<std::size_t>(std::min<std::uint64_t>(wanted, size_ - offset));
  if (offset < begin_ || offset + wanted > begin_ + filled_) {
    // Keep the overlapping bytes, so that sequential reading never reads a byte twice.
    std::size_t kept = 0;
    if (offset >= begin_ && offset < begin_ + filled_) {
      kept = static_cast<std::size_t>(begin_ + filled_ - offset);
      std::memmove(buffer_.data(), buffer_.data() + (offset - begin_), kept);
    }
    const std::size_t capacity = static_cast<std::size_t>(
        std::min<std::uint64_t>(std::max(wanted, kReadBytes), size_ - offset));
    if (buffer_.size() < capacity) buffer_.resize(capacity);
    stream_->clear();
    stream_->seekg(static_cast<std::streamoff>(offset + kept));
    stream_->read(reinterpret_cast<char*>(buffer_.data() + kept),
                  static_cast<std::streamsize>(capacity - kept));
    begin_ = offset;
    filled_ = kept + static_cast<std::size_t>(std::max<std::streamsize>(stream_->gcount(), 0));
    if (filled_ < capacity) size_ = begin_ + filled_;  // the file was truncated, or a read error
  }
  const std::size_t skip = static_cast<std::size_t>(offset - begin_);
  return {buffer_.data() + skip, filled_ - skip};
}

}  // namespace orchard::io
