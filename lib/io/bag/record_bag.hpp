// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <deque>
#include <functional>
#include <istream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "io/bag/bag_reader.hpp"
#include "io/byte_fields.hpp"
#include "io/log/file_window.hpp"

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

/// Decompresses data of a bag: bz2, lz4 (frame format) and zstd; "" or "none" is a copy.
///
/// Fills `unpacked`, whose size the caller has set to the size given in the file. Returns an empty
/// string, or the reason for failure: unknown compression, damage, or another size.
std::string unpack(const std::string& compression, const std::uint8_t* data, std::size_t size,
                   std::vector<std::uint8_t>& unpacked);

/// Whether the bytes begin like a zstd frame; rosbag2 compresses single messages that way.
bool is_zstd(const std::uint8_t* data, std::size_t size);

/// Returns the content size given in a zstd frame; 0 if none is given or it exceeds `most_bytes`.
std::size_t zstd_size(const std::uint8_t* data, std::size_t size, std::size_t most_bytes);

/// Reads a bag that is a file of records, some of them chunks of records: rosbag and MCAP.
class RecordBag : public BagReader {
 public:
  /// The stream must be seekable and begin with the format's magic.
  RecordBag(std::unique_ptr<std::istream> stream, std::unique_ptr<RecordFormat> format,
            std::function<void()> on_progress);

  std::optional<BagMessage> next() override;
  std::optional<BagMessage> at(const BagPlace& place) override;
  const std::vector<BagTopic>& topics() const override { return topics_; }
  const std::vector<std::string>& losses() const override { return losses_; }
  std::uint64_t position() const override { return position_; }
  std::uint64_t size() const override { return window_.size(); }

 private:
  /// An unpacked chunk and the position of its next record.
  struct Chunk {
    std::uint64_t place = 0;
    std::vector<std::uint8_t> content;
    std::uint64_t position = 0;
  };

  std::optional<BagMessage> next_in_chunk();
  void keep_recent(Chunk chunk);
  std::optional<BagMessage> message_of(const MessageRecord& record, const BagPlace& place);
  void add_topic(const TopicRecord& record);
  std::optional<std::vector<std::uint8_t>> content_of(const ChunkRecord& chunk,
                                                      std::uint64_t place);
  void go_on_behind_damage(const std::string& why);
  void lose(const std::string& what);
  void count_step();
  /// Returns the complete record at `place`; none when it ends beyond the file or is too large.
  std::optional<FileWindow::View> record_at(std::uint64_t place);

  FileWindow window_;
  std::unique_ptr<RecordFormat> format_;
  std::uint64_t position_ = 0;
  std::optional<Chunk> chunk_;  ///< current chunk of next()
  std::deque<Chunk> recent_;    ///< chunks unpacked by at()
  std::map<std::uint32_t, std::size_t> topic_of_id_;
  std::vector<BagTopic> topics_;
  std::vector<std::string> losses_;
  std::function<void()> on_progress_;
  std::uint64_t num_steps_ = 0;
  std::uint64_t unpacked_bytes_ = 0;  ///< of all chunks by next()
};

}  // namespace orchard::io
