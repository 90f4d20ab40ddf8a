// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "io/bag/bag_reader.hpp"

namespace orchard::io {

/// Contents of the records of a bag. Pointers point into the record.
struct TopicRecord {
  std::uint32_t id = 0;  ///< referred to by messages
  BagTopic topic;
};
struct MessageRecord {
  std::uint32_t topic_id = 0;
  std::int64_t utime = 0;
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;
};
struct ChunkRecord {
  std::string compression;
  std::uint64_t unpacked_size = 0;
  std::uint32_t crc = 0;  ///< of the unpacked data; 0: not given
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;
};
struct OtherRecord {};
struct LastRecord {};  ///< no message follows
struct DamagedRecord {
  std::string why;
};
using BagRecord =
    std::variant<OtherRecord, TopicRecord, MessageRecord, ChunkRecord, LastRecord, DamagedRecord>;

/// Common structure of rosbag's and MCAP's files: a magic followed by records, some of which are
/// chunks of records.
class RecordFormat {
 public:
  virtual ~RecordFormat() = default;

  virtual std::size_t magic_bytes() const = 0;

  /// Size in bytes of the record that begins here. 0: more than `size` bytes are needed to tell;
  /// none: not the beginning of a record.
  virtual std::optional<std::uint64_t> record_size(const std::uint8_t* bytes,
                                                   std::size_t size) const = 0;

  /// Whether a chunk record begins here. Tested at every byte to resume after damage, so it must
  /// hardly match by chance.
  virtual bool begins_chunk(const std::uint8_t* bytes, std::size_t size) const = 0;

  /// Parses a complete record. The format remembers what later records refer to (schemas).
  virtual BagRecord read(const std::uint8_t* bytes, std::size_t size) = 0;
};

std::unique_ptr<RecordFormat> make_rosbag_format();
std::unique_ptr<RecordFormat> make_mcap_format();

}  // namespace orchard::io
