// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "bus/messages/field_check.hpp"
#include "bus/messages/field_reader.hpp"
#include "bus/messages/field_writer.hpp"
#include "bus/messages/fields.hpp"
#include "bus/messages/wire_format.hpp"

namespace orchard::bus {

/// Encodes a message as LCM bytes.
template <class M>
std::vector<std::uint8_t> encode_fields(Channel channel, const M& message) {
  FieldWriter writer(type_hash(channel));
  visit_fields(message, writer);
  return std::move(writer).bytes();
}

/// Decodes a message and checks its size, type hash, array counts and field limits. Invalid bytes
/// never throw. `Fields` describes the wire layout of the bytes, which may be that of an older
/// version.
template <class M, class Fields>
std::variant<M, Rejection> decode_fields(Channel channel, const void* data, std::size_t size,
                                         Fields) {
  static const std::size_t min_bytes = encode_fields(channel, M{}).size();
  if (auto rejection = check_head(channel, data, size, min_bytes)) return *std::move(rejection);
  M message;
  FieldReader reader(static_cast<const std::uint8_t*>(data), size, sizeof(std::int64_t));
  Fields::visit(message, reader);
  if (auto rejection = std::move(reader).result()) return *std::move(rejection);
  FieldCheck check;
  Fields::visit(std::as_const(message), check);
  if (auto rejection = std::move(check).result()) return *std::move(rejection);
  return message;
}

}  // namespace orchard::bus
