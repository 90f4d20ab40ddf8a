// SPDX-License-Identifier: BSD-3-Clause
#include "io/recording/raw_bytes.hpp"

#include <array>

#include "io/file_error.hpp"

namespace orchard::io {
namespace {

constexpr std::string_view kRawBytesMagic = "ORCHRAW1";
constexpr std::uint32_t kEventMax_bytes = 1 << 20;
constexpr std::size_t kHeader_bytes = 13;

template <class Integer>
void put_big_endian(std::string& out, Integer value) {
  const auto bits = static_cast<std::uint64_t>(value);
  for (std::size_t i = sizeof(Integer); i-- > 0;) out += static_cast<char>(bits >> (8 * i));
}

std::uint64_t get_big_endian(const char* data, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value = value << 8 | static_cast<std::uint8_t>(data[i]);
  return value;
}

bool is_kind(char c) { return c == 'C' || c == 'R' || c == 'S' || c == 'T'; }

}  // namespace

RawBytesWriter::RawBytesWriter(const std::string& path)
    : path_(path), file_(path, std::ios::binary | std::ios::trunc) {
  file_ << kRawBytesMagic << std::flush;
  if (!file_) throw SystemError(path_ + ": cannot be written");
}

void RawBytesWriter::write(const RawEvent& event) {
  std::string record;
  put_big_endian(record, event.utime);
  record += static_cast<char>(event.kind);
  put_big_endian(record, static_cast<std::uint32_t>(event.bytes.size()));
  record += event.bytes;
  file_ << record << std::flush;
  if (!file_) throw SystemError(path_ + ": could not be written; is the disk full?");
}

RawBytesReader::RawBytesReader(const std::string& path)
    : path_(path), file_(path, std::ios::binary) {
  std::array<char, 8> magic{};
  if (!file_) throw FileError(path_ + ": cannot be opened");
  file_.read(magic.data(), magic.size());
  if (!file_ || std::string_view(magic.data(), magic.size()) != kRawBytesMagic) {
    throw FileError(path_ + ": not a recording of raw bytes (it does not start with ORCHRAW1)");
  }
}

std::optional<RawEvent> RawBytesReader::next() {
  std::array<char, kHeader_bytes> header{};
  if (!file_.read(header.data(), header.size())) return std::nullopt;
  RawEvent event;
  event.utime = static_cast<std::int64_t>(get_big_endian(header.data(), 8));
  const auto size = static_cast<std::uint32_t>(get_big_endian(header.data() + 9, 4));
  if (!is_kind(header[8]) || size > kEventMax_bytes) {
    throw FileError(path_ + ": damaged: an event has an invalid kind or size");
  }
  event.kind = static_cast<RawKind>(header[8]);
  event.bytes.resize(size);
  if (!file_.read(event.bytes.data(), size)) return std::nullopt;
  return event;
}

}  // namespace orchard::io
