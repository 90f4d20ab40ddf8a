// SPDX-License-Identifier: BSD-3-Clause
#include "bus/messages/codec.hpp"

#include <stdexcept>
#include <string>
#include <utility>

#include "bus/messages/field_codec.hpp"
#include "bus/messages/validity.hpp"

namespace orchard::bus {
namespace {

template <class M, class Fields>
std::variant<Message, Rejection> decode_as(Channel channel, const void* data, std::size_t size,
                                           Fields fields) {
  auto decoded = decode_fields<M>(channel, data, size, fields);
  if (auto* rejection = std::get_if<Rejection>(&decoded)) return std::move(*rejection);
  Message message = std::move(std::get<M>(decoded));
  if (auto rejection = check_consistency(message)) return *std::move(rejection);
  return message;
}

/// Finds the alternative of Message that belongs to the channel, starting at `kIndex`.
template <std::size_t kIndex = 0>
std::variant<Message, Rejection> decode_alternative(Channel channel, const void* data,
                                                    std::size_t size) {
  if constexpr (kIndex == std::variant_size_v<Message>) {
    throw std::invalid_argument("decode: unknown channel");
  } else {
    using M = std::variant_alternative_t<kIndex, Message>;
    if (channel != channel_of_alternative(kIndex)) {
      return decode_alternative<kIndex + 1>(channel, data, size);
    }
    return decode_as<M>(channel, data, size, fields_of(M{}));
  }
}

}  // namespace

std::string_view to_string(Reason reason) {
  switch (reason) {
    case Reason::kTooShort:
      return "too_short";
    case Reason::kTooLarge:
      return "too_large";
    case Reason::kWrongType:
      return "wrong_type";
    case Reason::kBadCount:
      return "bad_count";
    case Reason::kUndecodable:
      return "undecodable";
    case Reason::kNotFinite:
      return "not_finite";
    case Reason::kOutOfRange:
      return "out_of_range";
    case Reason::kInconsistent:
      return "inconsistent";
  }
  return "unknown";
}

std::vector<std::uint8_t> encode(const Message& message) {
  return std::visit([&](const auto& m) { return encode_fields(channel_of(message), m); }, message);
}

std::variant<Message, Rejection> decode(Channel channel, const void* data, std::size_t size) {
  if (info(channel).role == Role::kService) {
    throw std::invalid_argument("decode: " + std::string(info(channel).name) +
                                " is a service channel");
  }
  const bool has_hash =
      data != nullptr && size >= sizeof(std::int64_t) && size <= max_bytes(channel);
  if (has_hash && is_older_form(channel, data)) {
    return decode_as<detection::Detections>(channel, data, size,
                                            detection::DetectionsFields<true>{});
  }
  return decode_alternative(channel, data, size);
}

}  // namespace orchard::bus
