// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace orchard::device {

/// Notices a camera that hangs: no sensor gives the same bytes twice, its noise alone differs.
class FrameWatch {
 public:
  void add(const std::vector<std::uint8_t>& data) {
    num_same_ = data == last_ ? num_same_ + 1 : 0;
    if (num_same_ == 0) last_ = data;
  }

  /// Ten pictures in a row were the same.
  bool is_frozen() const { return num_same_ >= kMaxSame; }

  void restart() { num_same_ = 0; }

 private:
  static constexpr int kMaxSame = 9;
  std::vector<std::uint8_t> last_;
  int num_same_ = 0;
};

}  // namespace orchard::device
