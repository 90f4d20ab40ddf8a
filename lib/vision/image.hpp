// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace orchard::vision {

enum class Encoding : std::int8_t { kJpeg = 0, kBgr8 = 1, kGray8 = 2 };

/// One image as sent by the camera driver, not decoded.
struct Image {
  std::int64_t utime = 0;  ///< mid-exposure [us]
  std::int32_t seq = 0;    ///< +1 per image of its source
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
  Encoding encoding = Encoding::kJpeg;
  std::vector<std::uint8_t> data;
};

/// The fields of image_t in the order of the wire; see bus/messages/fields.hpp.
struct ImageFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.stamp(m.utime, m.seq);
    v.count("num_bytes", m.data);
    v.field("width_px", m.width_px, 1, 16384);
    v.field("height_px", m.height_px, 1, 16384);
    v.field("encoding", m.encoding, 0, 2);
    v.array("data", m.data, "num_bytes");
  }
};

inline ImageFields fields_of(const Image&) { return {}; }

}  // namespace orchard::vision
