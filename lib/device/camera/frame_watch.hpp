// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace orchard::device {

/// Detects a camera that hangs: sensor noise makes any two real pictures differ, so identical bytes
/// mean a frozen stream.
class FrameWatch {
 public:
  void add(const std::vector<std::uint8_t>& data) {
    num_same_ = data == last_ ? num_same_ + 1 : 0;
    if (num_same_ == 0) last_ = data;
  }

  /// True after ten identical pictures in a row.
  bool is_frozen() const { return num_same_ >= kMaxSame; }

  void restart() { num_same_ = 0; }

 private:
  static constexpr int kMaxSame = 9;
  std::vector<std::uint8_t> last_;
  int num_same_ = 0;
};

}  // namespace orchard::device
