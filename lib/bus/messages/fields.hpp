// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "bus/messages/message.hpp"
#include "detection/detection.hpp"
#include "laser/scan.hpp"
#include "mapping/finish/map_fields.hpp"
#include "pose/pose_fields.hpp"
#include "timing/drive_time.hpp"
#include "vision/image.hpp"

namespace orchard::bus {

/// Upper limit (exclusive) of any time in a message: 2200-01-01 [us].
inline constexpr std::int64_t kUtimeEnd = timing::kEpoch_us;

/// Calls a visitor with every field of a message, in the order of its .lcm file.
///
/// The fields of a type are listed once, in a ..._fields.hpp beside the struct; encoding, decoding,
/// limits, text output and tests all use this list. `fields_of(m)` finds it. A visitor `v` has
///   v.stamp(utime, seq)                   the two fields that every message begins with
///   v.time(name, utime)                   a time of measurement
///   v.field(name, value, lo, hi)          a number, enum (as its number), bool, or std::array
///   v.covariance(name, values)            an upper triangle row by row, as std::array
///   v.count(name, vector)                 the number of elements of an array
///   v.array(name, vector, count[, lo, hi])  of numbers; without limits a check of its own
///   v.items(name, vector, count, Fields)  of structs whose fields these are
///   v.column(name, vector, count, &Element::member, lo, hi)  one member of each element
///   v.text(name, string)
/// NaN and infinity violate any limits.
template <class M, class Visitor>
void visit_fields(M& message, Visitor& visitor) {
  decltype(fields_of(message))::visit(message, visitor);
}

}  // namespace orchard::bus
