// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "io/bag/bag_reader.hpp"

namespace orchard::io {

/// What a record of a bag says. Pointers point into the record.
struct TopicRecord {
  std::uint32_t id = 0;  ///< by which messages name it
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
  std::uint32_t crc = 0;  ///< of what is unpacked; 0: not stated
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;
};
struct OtherRecord {};
struct LastRecord {};  ///< behind it stands no message
struct DamagedRecord {
  std::string why;
};
using BagRecord =
    std::variant<OtherRecord, TopicRecord, MessageRecord, ChunkRecord, LastRecord, DamagedRecord>;

/// rosbag's and MCAP's files alike: after a magic records, some of which are chunks of records.
class RecordFormat {
 public:
  virtual ~RecordFormat() = default;

  virtual std::size_t magic_bytes() const = 0;

  /// How many bytes the record that begins here has. 0: more than `size` must be seen to know;
  /// none: no record begins like this.
  virtual std::optional<std::uint64_t> record_size(const std::uint8_t* bytes,
                                                   std::size_t size) const = 0;

  /// Whether a chunk's record begins here: asked byte by byte to go on behind damage, so it must be
  /// hard to be met by chance.
  virtual bool begins_chunk(const std::uint8_t* bytes, std::size_t size) const = 0;

  /// What a whole record says. Formats remember what later records stand on (schemas).
  virtual BagRecord read(const std::uint8_t* bytes, std::size_t size) = 0;
};

std::unique_ptr<RecordFormat> make_rosbag_format();
std::unique_ptr<RecordFormat> make_mcap_format();

}  // namespace orchard::io
