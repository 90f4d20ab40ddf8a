// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vision/image.hpp"

namespace orchard::vision {

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
