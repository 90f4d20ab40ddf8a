// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace orchard::device {

/// Cuts a stream of bytes into lines, ended by LF, CR or both; empty ones are left out. A line of
/// more than `max_bytes` is dropped and counted: no sender makes it keep more than that.
class LineSplitter {
 public:
  explicit LineSplitter(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  /// Forgets the half line that it holds. `in_mid_line`: the stream is joined at any place, so what
  /// comes before the first line end is no line.
  void restart(bool in_mid_line);

  /// Takes bytes in pieces of any size and hands on each line that they end, without its end.
  void add(std::string_view bytes, const std::function<void(std::string_view)>& take_line);

  std::int64_t num_too_long() const { return num_too_long_; }

 private:
  void append(std::string_view bytes);
  void end_line(const std::function<void(std::string_view)>& take_line);

  std::size_t max_bytes_;
  std::string line_;
  bool is_skipping_ = false;  ///< up to the next line end
  std::int64_t num_too_long_ = 0;
};

/// Makes any bytes readable for a person: what is not printable is a question mark, and what is
/// longer than `max_bytes` is cut.
std::string shown_text(std::string_view bytes, std::size_t max_bytes);

}  // namespace orchard::device
