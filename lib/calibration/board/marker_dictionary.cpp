// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/board/marker_dictionary.hpp"

#include <array>
#include <opencv2/aruco/dictionary.hpp>

namespace orchard::calibration {
namespace {

constexpr std::array<int, 4> kCounts{50, 100, 250, 1000};

}  // namespace

std::optional<int> marker_dictionary(const std::string& name) {
  // OpenCV numbers the dictionaries by bits, then by count.
  static_assert(cv::aruco::DICT_4X4_50 == 0 && cv::aruco::DICT_7X7_1000 == 15);
  for (int bits = 4; bits <= 7; ++bits) {
    for (std::size_t i = 0; i < kCounts.size(); ++i) {
      if (name ==
          std::to_string(bits) + "x" + std::to_string(bits) + "_" + std::to_string(kCounts[i])) {
        return 4 * (bits - 4) + static_cast<int>(i);
      }
    }
  }
  return std::nullopt;
}

int marker_count(const std::string& name) {
  const auto number = marker_dictionary(name);
  return number ? kCounts[static_cast<std::size_t>(*number % 4)] : 0;
}

}  // namespace orchard::calibration
