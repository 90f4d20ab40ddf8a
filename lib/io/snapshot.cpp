// SPDX-License-Identifier: BSD-3-Clause
#include "io/snapshot.hpp"

#include <zlib.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>

#include "io/atomic_file.hpp"
#include "io/file_error.hpp"

namespace orchard::io {
namespace {

constexpr std::string_view kSnapshotMagic = "ORCHSNAP";
/// Increment when the meaning of a state's bytes changes although their number does not.
constexpr std::uint32_t kVersion = 1;

template <class Unsigned>
void put(std::string& to, Unsigned value) {
  for (std::size_t i = 0; i < sizeof(Unsigned); ++i) {
    to.push_back(static_cast<char>(static_cast<std::uint8_t>(value >> (8 * i))));
  }
}

/// Reads numbers from the front of the bytes; zeros beyond the end, which is_whole() reports.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : left_(bytes) {}
  template <class Unsigned>
  Unsigned number() {
    const std::string_view bytes = take(sizeof(Unsigned));
    Unsigned value = 0;
    for (std::size_t i = bytes.size(); i-- > 0;) {
      value = static_cast<Unsigned>(value << 8 | static_cast<std::uint8_t>(bytes[i]));
    }
    return value;
  }
  std::string_view take(std::uint64_t size) {
    if (size > left_.size()) {
      is_whole_ = false;
      return {};
    }
    const std::string_view bytes = left_.substr(0, size);
    left_.remove_prefix(size);
    return bytes;
  }
  bool is_whole() const { return is_whole_; }
  std::size_t num_left() const { return left_.size(); }

 private:
  std::string_view left_;
  bool is_whole_ = true;
};

std::uint32_t crc_of(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      ::crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace

void write_snapshot(const std::string& path, std::int64_t identity, const Snapshot& snapshot) {
  std::string bytes(kSnapshotMagic);
  put(bytes, kVersion);
  put(bytes, static_cast<std::uint64_t>(identity));
  put(bytes, snapshot.journal_number);
  put(bytes, snapshot.journal_bytes);
  put(bytes, static_cast<std::uint32_t>(snapshot.chunks.size()));
  for (const PersistentChunk& chunk : snapshot.chunks) {
    put(bytes, chunk.number);
    put(bytes, chunk.crc);
  }
  put(bytes, static_cast<std::uint64_t>(snapshot.state.size()));
  bytes += snapshot.state;
  put(bytes, crc_of(bytes));
  write_file_atomically(path, bytes);
}

SnapshotReading read_snapshot(const std::string& path, std::int64_t identity) {
  SnapshotReading reading;
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return reading;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw FileError(path + " is not a regular file; give another folder");
  }
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  if (!file || !(content << file.rdbuf())) {
    throw FileError(path + ": cannot be read (" + std::strerror(errno) + ")");
  }
  const std::string bytes = content.str();
  reading.state = SnapshotReading::State::kDamaged;
  if (bytes.size() < sizeof(std::uint32_t)) return reading;
  const std::string_view checked(bytes.data(), bytes.size() - sizeof(std::uint32_t));
  if (Reader({bytes.data() + checked.size(), 4}).number<std::uint32_t>() != crc_of(checked)) {
    return reading;
  }
  Reader reader(checked);
  if (reader.take(kSnapshotMagic.size()) != kSnapshotMagic ||
      reader.number<std::uint32_t>() != kVersion) {
    return reading;
  }
  if (static_cast<std::int64_t>(reader.number<std::uint64_t>()) != identity) {
    reading.state = SnapshotReading::State::kOtherMaker;
    return reading;
  }
  Snapshot& snapshot = reading.snapshot;
  snapshot.journal_number = reader.number<std::uint64_t>();
  snapshot.journal_bytes = reader.number<std::uint64_t>();
  const auto num_chunks = reader.number<std::uint32_t>();
  for (std::uint32_t i = 0; i < num_chunks && reader.is_whole(); ++i) {
    const auto number = reader.number<std::uint32_t>();
    const auto crc = reader.number<std::uint32_t>();
    if (!snapshot.chunks.empty() && number <= snapshot.chunks.back().number) return reading;
    snapshot.chunks.push_back({number, crc});
  }
  snapshot.state = reader.take(reader.number<std::uint64_t>());
  if (reader.is_whole() && reader.num_left() == 0) reading.state = SnapshotReading::State::kWhole;
  return reading;
}

}  // namespace orchard::io
