// SPDX-License-Identifier: BSD-3-Clause
#include "device/cola/cola_telegram.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>

namespace orchard::device {
namespace {

constexpr char kStx = '\x02';
constexpr char kEtx = '\x03';
constexpr std::string_view kStart = "\x02\x02\x02\x02";

/// Before the content of a CoLa-B telegram: the start and the length. After it: the checksum.
constexpr std::size_t kHead = 8;
constexpr std::size_t kSum = 1;

char checksum(std::string_view content) {
  char sum = 0;
  for (const char byte : content) sum = static_cast<char>(sum ^ byte);
  return sum;
}

std::uint32_t number_in(std::string_view bytes) {
  std::uint32_t number = 0;
  for (const char byte : bytes) number = number << 8 | static_cast<unsigned char>(byte);
  return number;
}

using Kind = ColaPiece::Kind;

ColaPiece first_text(std::string_view bytes) {
  if (bytes.empty()) return {};
  if (bytes.front() != kStx) return {Kind::kNoise, std::min(bytes.find(kStx), bytes.size()), {}};
  const std::size_t end = bytes.find_first_of("\x02\x03", 1);
  if (end == std::string_view::npos) return {};
  if (bytes[end] == kStx) return {Kind::kBroken, end, {}};
  return {Kind::kTelegram, end + 1, bytes.substr(1, end - 1)};
}

/// Length of the bytes before the next start, of which the last ones may be the beginning.
std::size_t until_start(std::string_view bytes, std::size_t from) {
  const std::size_t start = bytes.find(kStart, from);
  if (start != std::string_view::npos) return start;
  std::size_t end = bytes.size();
  while (end > from && end > bytes.size() - std::min(bytes.size(), kStart.size() - 1) &&
         bytes[end - 1] == kStx) {
    --end;
  }
  return end;
}

/// The telegram that `bytes`, which begin with a start, hold by their own length.
ColaPiece framed_piece(std::string_view bytes, std::size_t max_bytes) {
  if (bytes.size() < kHead) return {};
  const std::size_t length = number_in(bytes.substr(kStart.size(), kHead - kStart.size()));
  if (length > max_bytes) return {Kind::kBroken, until_start(bytes, 1), {}};
  const std::size_t end = kHead + length + kSum;
  if (bytes.size() < end) return {};
  const std::string_view content = bytes.substr(kHead, length);
  if (checksum(content) == bytes[end - 1]) return {Kind::kTelegram, end, content};
  // Either its content is damaged or its length, and then another telegram begins within it.
  const bool ends_here = bytes.size() == end || bytes.substr(end, kStart.size()) == kStart;
  return {Kind::kBroken, ends_here ? end : until_start(bytes, 1), {}};
}

ColaPiece first_binary(std::string_view bytes, std::size_t max_bytes) {
  if (const std::size_t noise = until_start(bytes, 0); noise > 0) return {Kind::kNoise, noise, {}};
  const ColaPiece piece = framed_piece(bytes, max_bytes);
  if (piece.kind != Kind::kIncomplete) return piece;
  // A whole telegram behind it shows that the end is missing, or that the length is wrong.
  for (std::size_t next = 1; (next = bytes.find(kStart, next)) != std::string_view::npos; ++next) {
    if (framed_piece(bytes.substr(next), max_bytes).kind == Kind::kTelegram) {
      return {Kind::kBroken, next, {}};
    }
  }
  return {};
}

}  // namespace

std::string_view name_of(ColaDialect dialect) {
  return dialect == ColaDialect::kA ? "CoLa-A" : "CoLa-B";
}

std::string framed(ColaDialect dialect, std::string_view telegram) {
  if (dialect == ColaDialect::kA) return kStx + std::string(telegram) + kEtx;
  std::string bytes(kStart);
  for (int shift = 24; shift >= 0; shift -= 8) {
    bytes += static_cast<char>(telegram.size() >> shift & 0xff);
  }
  return bytes.append(telegram) + checksum(telegram);
}

ColaPiece first_piece(ColaDialect dialect, std::string_view bytes, std::size_t max_bytes) {
  return dialect == ColaDialect::kA ? first_text(bytes) : first_binary(bytes, max_bytes);
}

std::string_view ColaFields::word() {
  const std::size_t end = rest_.find(' ');
  const std::string_view field = ok_ ? rest_.substr(0, end) : std::string_view();
  rest_ = end == std::string_view::npos ? std::string_view() : rest_.substr(end + 1);
  if (field.empty()) ok_ = false;
  return field;
}

std::string_view ColaFields::text(std::size_t num_characters) {
  // As text, a blank follows unless it is the last field.
  const bool is_separated = dialect_ == ColaDialect::kA && num_characters < rest_.size();
  if (!ok_ || num_characters > rest_.size() || (is_separated && rest_[num_characters] != ' ')) {
    ok_ = false;
    return {};
  }
  const std::string_view field = rest_.substr(0, num_characters);
  rest_.remove_prefix(num_characters + (is_separated ? 1 : 0));
  return field;
}

std::uint32_t ColaFields::number(int num_bytes, std::uint32_t max) {
  const auto size = static_cast<std::size_t>(num_bytes);
  const std::uint32_t number = dialect_ == ColaDialect::kA ? hexadecimal() : big_endian(size);
  if (number > std::min(max, 0xffffffffu >> (32 - 8 * size))) ok_ = false;
  return ok_ ? number : 0;
}

std::uint32_t ColaFields::hexadecimal() {
  const std::string_view field = word();
  std::uint32_t number = 0;
  const auto end = field.data() + field.size();
  const auto result = std::from_chars(field.data(), end, number, 16);
  if (field.size() > 8 || result.ec != std::errc() || result.ptr != end) ok_ = false;
  return number;
}

std::uint32_t ColaFields::big_endian(std::size_t num_bytes) {
  if (rest_.size() < num_bytes) ok_ = false;
  if (!ok_) return 0;
  const std::uint32_t number = number_in(rest_.substr(0, num_bytes));
  rest_.remove_prefix(num_bytes);
  return number;
}

std::int32_t ColaFields::signed_number() {
  const bool is_decimal = dialect_ == ColaDialect::kA && !rest_.empty() &&
                          (rest_.front() == '+' || rest_.front() == '-');
  std::int32_t value = 0;
  if (!is_decimal) {
    const std::uint32_t bits = number(4);
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
  std::string_view field = word();
  if (!field.empty() && field.front() == '+') field.remove_prefix(1);
  const auto end = field.data() + field.size();
  const auto result = std::from_chars(field.data(), end, value);
  if (!ok_ || result.ec != std::errc() || result.ptr != end) ok_ = false;
  return ok_ ? value : 0;
}

float ColaFields::real() {
  const std::uint32_t bits = number(4);
  float value = 0.0f;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

void ColaFields::skip(int num_fields, int num_bytes) {
  for (int i = 0; i < num_fields; ++i) {
    if (dialect_ == ColaDialect::kA) {
      word();
    } else {
      big_endian(static_cast<std::size_t>(num_bytes));
    }
  }
}

}  // namespace orchard::device
