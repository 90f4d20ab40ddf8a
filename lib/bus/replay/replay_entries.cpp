// SPDX-License-Identifier: BSD-3-Clause
#include "bus/replay/replay_entries.hpp"

namespace orchard::bus {
namespace {

/// Seven bits a byte, the lowest first; differences of either sign are small numbers.
void put(std::uint64_t value, std::vector<std::uint8_t>& bytes) {
  for (; value >= 0x80; value >>= 7) bytes.push_back(static_cast<std::uint8_t>(value | 0x80));
  bytes.push_back(static_cast<std::uint8_t>(value));
}

std::uint64_t get(const std::vector<std::uint8_t>& bytes, std::size_t& at) {
  std::uint64_t value = 0;
  for (int shift = 0;; shift += 7) {
    const std::uint8_t byte = bytes[at++];
    value |= std::uint64_t{byte & 0x7Fu} << shift;
    if (byte < 0x80) return value;
  }
}

/// Modulo 2^64, so that any two values have a difference.
std::uint64_t folded(std::uint64_t now, std::uint64_t before) {
  const std::uint64_t change = now - before;
  return (change << 1) ^ (0 - (change >> 63));
}
std::uint64_t unfolded(std::uint64_t folded_change, std::uint64_t before) {
  return before + ((folded_change >> 1) ^ (0 - (folded_change & 1)));
}

}  // namespace

void ReplayEntries::push_back(const ReplayEntry& entry) {
  std::int32_t& seq = last_.seq[static_cast<std::size_t>(entry.channel)];
  bytes_.push_back(static_cast<std::uint8_t>(entry.channel));
  put(folded(static_cast<std::uint64_t>(entry.utime), static_cast<std::uint64_t>(last_.utime)),
      bytes_);
  put(folded(static_cast<std::uint64_t>(entry.seq), static_cast<std::uint64_t>(seq)), bytes_);
  put(folded(entry.offset, last_.offset), bytes_);
  last_.utime = entry.utime;
  last_.offset = entry.offset;
  seq = entry.seq;
  ++size_;
}

void ReplayEntries::Iterator::read() {
  if (at_ == bytes_->size()) return;
  next_ = at_;
  entry_.channel = static_cast<Channel>((*bytes_)[next_++]);
  std::int32_t& seq = last_.seq[static_cast<std::size_t>(entry_.channel)];
  last_.utime = static_cast<std::int64_t>(
      unfolded(get(*bytes_, next_), static_cast<std::uint64_t>(last_.utime)));
  seq = static_cast<std::int32_t>(unfolded(get(*bytes_, next_), static_cast<std::uint64_t>(seq)));
  last_.offset = unfolded(get(*bytes_, next_), last_.offset);
  entry_.utime = last_.utime;
  entry_.seq = seq;
  entry_.offset = last_.offset;
}

ReplayEntries::Iterator ReplayEntries::begin() const {
  Iterator first(bytes_, 0);
  first.read();
  return first;
}

ReplayEntries::Iterator& ReplayEntries::Iterator::operator++() {
  at_ = next_;
  read();
  return *this;
}

}  // namespace orchard::bus
