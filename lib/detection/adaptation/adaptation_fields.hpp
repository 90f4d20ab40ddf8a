// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "detection/adaptation/adaptation_step.hpp"

namespace orchard::detection {

/// The fields of adaptation_t in the order of the wire; see bus/messages/fields.hpp.
struct AdaptationFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.stamp(m.utime, m.seq);
    v.field("action", m.action, 1, 5);
    v.field("reason", m.reason, 0, 4);
    v.field("num_width_trees", m.num_width_trees, 0, INT32_MAX);
    v.field("num_colour_trees", m.num_colour_trees, 0, INT32_MAX);
    v.field("confident_share", m.confident_share, 0, 1);
    v.field("width_mean_m", m.model.width_mean_m, 0, 1e5);
    v.field("light_blue", m.model.light.blue, -10, 10);
    v.field("light_red", m.model.light.red, -10, 10);
    v.field("light_green", m.model.light.green, -10, 10);
  }
};

inline AdaptationFields fields_of(const AdaptationStep&) { return {}; }

}  // namespace orchard::detection
