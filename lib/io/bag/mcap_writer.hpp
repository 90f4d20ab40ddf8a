// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

namespace orchard::io {

/// Writes an MCAP file (mcap.dev/spec) of profile ros2: CDR messages in zstd-compressed chunks,
/// each with its index, and a summary, so that a viewer can seek to any time.
class McapWriter {
 public:
  /// The stream must outlive the writer.
  explicit McapWriter(std::ostream& out);

  /// Adds a topic with messages of a type; returns its number for write(). `definition`: of the
  /// type and those within it. `is_kept`: a late subscriber gets the last message, too.
  std::uint16_t add_topic(const std::string& topic, const std::string& type,
                          const std::string& definition, bool is_kept);

  void write(std::uint16_t topic, std::int64_t utime, std::string_view cdr);

  /// Writes the last chunk and the summary; nothing may be written afterwards.
  void finish();

  std::uint64_t num_messages() const { return num_messages_; }

 private:
  struct ChunkPlace {
    std::uint64_t first_ns, last_ns, offset, size, packed_size, content_size, index_size;
    std::map<std::uint16_t, std::uint64_t> indexes;  ///< offset of each topic's message index
  };
  void put(std::string_view bytes);
  void put_record(std::uint8_t opcode, std::string_view content);
  void finish_chunk();
  std::string statistics() const;

  std::ostream& out_;
  std::uint64_t position_ = 0;
  std::string topics_;  ///< schema and channel records, repeated in the summary
  std::map<std::string, std::uint16_t> schema_of_;
  std::vector<std::uint64_t> num_of_topic_;
  std::string chunk_;
  std::uint64_t chunk_first_ns_ = 0, chunk_last_ns_ = 0;
  std::map<std::uint16_t, std::string> chunk_indexes_;  ///< pairs of time and offset
  std::vector<ChunkPlace> chunks_;
  std::uint64_t num_messages_ = 0, first_ns_ = 0, last_ns_ = 0;
};

}  // namespace orchard::io
