// SPDX-License-Identifier: BSD-3-Clause
#include "device/lines/line_splitter.hpp"

namespace orchard::device {

void LineSplitter::restart(bool in_mid_line) {
  line_.clear();
  is_skipping_ = in_mid_line;
}

void LineSplitter::add(std::string_view bytes,
                       const std::function<void(std::string_view)>& take_line) {
  while (!bytes.empty()) {
    const std::size_t end = bytes.find_first_of("\r\n");
    append(bytes.substr(0, end));
    if (end == std::string_view::npos) return;
    end_line(take_line);
    bytes.remove_prefix(end + 1);
  }
}

void LineSplitter::append(std::string_view bytes) {
  if (is_skipping_) return;
  if (bytes.size() > max_bytes_ - line_.size()) {
    ++num_too_long_;
    line_.clear();
    is_skipping_ = true;
    return;
  }
  line_ += bytes;
}

void LineSplitter::end_line(const std::function<void(std::string_view)>& take_line) {
  if (!is_skipping_ && !line_.empty()) take_line(line_);
  line_.clear();
  is_skipping_ = false;
}

std::string shown_text(std::string_view bytes, std::size_t max_bytes) {
  std::string text;
  for (const char byte : bytes.substr(0, max_bytes)) {
    text += byte >= ' ' && byte <= '~' ? byte : '?';
  }
  return text + (bytes.size() > max_bytes ? "..." : "");
}

}  // namespace orchard::device
