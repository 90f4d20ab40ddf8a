// SPDX-License-Identifier: BSD-3-Clause

// MCAP, by its specification (mcap.dev/spec): each record has an opcode, a length of eight bytes,
// and content; chunks contain schemas, channels and messages.

#include "io/bag/mcap_writer.hpp"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>

#include "io/bag/record_bag.hpp"
#include "io/byte_fields.hpp"

namespace orchard::io {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr std::size_t kChunkBytes = std::size_t{1} << 20;

enum Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kDataEnd = 0x0F,
};

std::string record(std::uint8_t opcode, std::string_view content) {
  return static_cast<char>(opcode) + number_bytes(static_cast<std::uint64_t>(content.size())) +
         std::string(content);
}

/// Quality of service of a topic whose last message a late subscriber gets (durability 1), as
/// rosbag2 writes it since ROS 2 Foxy.
constexpr char kKeptProfile[] =
    "- history: 1\n  depth: 1\n  reliability: 1\n  durability: 1\n"
    "  deadline: {sec: 9223372036, nsec: 854775807}\n"
    "  lifespan: {sec: 9223372036, nsec: 854775807}\n  liveliness: 1\n"
    "  liveliness_lease_duration: {sec: 9223372036, nsec: 854775807}\n"
    "  avoid_ros_namespace_conventions: false\n";

constexpr std::size_t kHeadBytes = 9;
constexpr std::int64_t kNanosecondsPerMicrosecond = 1000;

class McapFormat : public RecordFormat {
 public:
  std::size_t magic_bytes() const override { return 8; }

  std::optional<std::uint64_t> record_size(const std::uint8_t* bytes,
                                           std::size_t size) const override {
    constexpr std::uint64_t kMaxBytes = std::uint64_t{1} << 40;
    if (size < kHeadBytes) return 0;
    ByteFields fields(bytes, size);
    const auto opcode = fields.number<std::uint8_t>();
    const auto length = fields.number<std::uint64_t>();
    if (opcode == 0 || length > kMaxBytes) return std::nullopt;
    return kHeadBytes + length;
  }

  bool begins_chunk(const std::uint8_t* bytes, std::size_t size) const override {
    ByteFields fields(bytes, size);
    if (fields.number<std::uint8_t>() != kChunk) return false;
    const auto length = fields.number<std::uint64_t>();
    fields.take(28);  // times, length and checksum of the content
    const auto name_size = fields.number<std::uint32_t>();
    if (!fields.ok() || name_size > 4) return false;
    fields.take(name_size);
    const auto content_size = fields.number<std::uint64_t>();
    return fields.ok() && length == content_size + 40 + name_size;
  }

  BagRecord read(const std::uint8_t* bytes, std::size_t size) override {
    ByteFields fields(bytes + kHeadBytes, size - kHeadBytes);
    switch (bytes[0]) {
      case kSchema:
        return read_schema(fields);
      case kChannel:
        return read_channel(fields);
      case kMessage:
        return read_message(fields);
      case kChunk:
        return read_chunk(fields);
      case kDataEnd:
      case kFooter:
        return LastRecord{};
      default:
        return OtherRecord{};
    }
  }

 private:
  BagRecord read_schema(ByteFields& fields) {
    const auto id = fields.number<std::uint16_t>();
    std::string name = fields.text();
    if (!fields.ok()) return DamagedRecord{"a truncated schema"};
    schema_names_[id] = std::move(name);
    return OtherRecord{};
  }

  BagRecord read_channel(ByteFields& fields) {
    TopicRecord record;
    record.id = fields.number<std::uint16_t>();
    const auto schema_id = fields.number<std::uint16_t>();
    record.topic.name = fields.text();
    const std::string encoding = fields.text();
    if (!fields.ok()) return DamagedRecord{"a truncated channel"};
    const auto schema = schema_names_.find(schema_id);
    if (schema != schema_names_.end()) record.topic.type = schema->second;
    record.topic.wire = encoding == "ros1" ? ros::Wire::kRos1 : ros::Wire::kCdr;
    record.topic.is_known_wire = encoding == "ros1" || encoding == "cdr";
    return record;
  }

  static BagRecord read_message(ByteFields& fields) {
    MessageRecord record;
    record.topic_id = fields.number<std::uint16_t>();
    fields.number<std::uint32_t>();  // sequence
    const auto log_time_ns = fields.number<std::uint64_t>();
    fields.number<std::uint64_t>();  // publish time
    if (!fields.ok()) return DamagedRecord{"a truncated message"};
    record.utime = static_cast<std::int64_t>(log_time_ns / kNanosecondsPerMicrosecond);
    record.size = fields.left();
    record.data = fields.take(record.size);
    return record;
  }

  static BagRecord read_chunk(ByteFields& fields) {
    ChunkRecord record;
    fields.number<std::uint64_t>();  // first and last time
    fields.number<std::uint64_t>();
    record.unpacked_size = fields.number<std::uint64_t>();
    record.crc = fields.number<std::uint32_t>();
    record.compression = fields.text();
    const auto size = fields.number<std::uint64_t>();
    record.data = fields.take(size);
    if (!fields.ok()) return DamagedRecord{"a truncated chunk"};
    record.size = static_cast<std::size_t>(size);
    return record;
  }

  std::map<std::uint16_t, std::string> schema_names_;
};

}  // namespace

McapWriter::McapWriter(std::ostream& out) : out_(out) {
  put(kMagic);
  put_record(kHeader, text_bytes("ros2") + text_bytes("orchard-mapper"));
}

void McapWriter::put(std::string_view bytes) {
  out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  position_ += bytes.size();
}

void McapWriter::put_record(std::uint8_t opcode, std::string_view content) {
  put(record(opcode, content));
}

std::uint16_t McapWriter::add_topic(const std::string& topic, const std::string& type,
                                    const std::string& definition, bool is_kept) {
  std::string records;
  auto& schema = schema_of_[type];
  if (schema == 0) {
    schema = static_cast<std::uint16_t>(schema_of_.size());
    records += record(kSchema, number_bytes(schema) + text_bytes(type) + text_bytes("ros2msg") +
                                   text_bytes(definition));
  }
  num_of_topic_.push_back(0);
  const auto id = static_cast<std::uint16_t>(num_of_topic_.size());
  records += record(
      kChannel,
      number_bytes(id) + number_bytes(schema) + text_bytes(topic) + text_bytes("cdr") +
          text_bytes(text_bytes("offered_qos_profiles") + text_bytes(is_kept ? kKeptProfile : "")));
  chunk_ += records;
  topics_ += records;
  return id;
}

void McapWriter::write(std::uint16_t topic, std::int64_t utime, std::string_view cdr) {
  const std::uint64_t time_ns = static_cast<std::uint64_t>(std::max<std::int64_t>(0, utime)) * 1000;
  const bool is_first_of_chunk = chunk_indexes_.empty();
  chunk_first_ns_ = is_first_of_chunk ? time_ns : std::min(chunk_first_ns_, time_ns);
  chunk_last_ns_ = is_first_of_chunk ? time_ns : std::max(chunk_last_ns_, time_ns);
  first_ns_ = num_messages_ == 0 ? time_ns : std::min(first_ns_, time_ns);
  last_ns_ = std::max(last_ns_, time_ns);
  chunk_indexes_[topic] +=
      number_bytes(time_ns) + number_bytes(static_cast<std::uint64_t>(chunk_.size()));
  auto& num = num_of_topic_.at(topic - 1u);
  chunk_ += record(kMessage, number_bytes(topic) + number_bytes(static_cast<std::uint32_t>(num)) +
                                 number_bytes(time_ns) + number_bytes(time_ns) + std::string(cdr));
  ++num;
  ++num_messages_;
  if (chunk_.size() >= kChunkBytes) finish_chunk();
}

void McapWriter::finish_chunk() {
  if (chunk_.empty()) return;
  constexpr int kLevel = 3;
  std::string packed(ZSTD_compressBound(chunk_.size()), '\0');
  const std::size_t size =
      ZSTD_compress(packed.data(), packed.size(), chunk_.data(), chunk_.size(), kLevel);
  if (ZSTD_isError(size)) throw std::runtime_error("zstd failed to compress a chunk");
  packed.resize(size);
  const std::uint32_t crc = static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const unsigned char*>(chunk_.data()), chunk_.size()));
  ChunkPlace place{};
  place.first_ns = chunk_first_ns_;
  place.last_ns = chunk_last_ns_;
  place.offset = position_;
  place.packed_size = packed.size();
  place.content_size = chunk_.size();
  put_record(kChunk, number_bytes(chunk_first_ns_) + number_bytes(chunk_last_ns_) +
                         number_bytes(static_cast<std::uint64_t>(chunk_.size())) +
                         number_bytes(crc) + text_bytes("zstd") +
                         number_bytes(static_cast<std::uint64_t>(packed.size())) + packed);
  place.size = position_ - place.offset;
  for (const auto& [topic, entries] : chunk_indexes_) {
    place.indexes[topic] = position_;
    put_record(kMessageIndex, number_bytes(topic) + text_bytes(entries));
  }
  place.index_size = position_ - place.offset - place.size;
  chunks_.push_back(std::move(place));
  chunk_.clear();
  chunk_indexes_.clear();
  chunk_first_ns_ = chunk_last_ns_ = 0;
}

std::string McapWriter::statistics() const {
  std::string counts;
  for (std::size_t i = 0; i < num_of_topic_.size(); ++i) {
    counts += number_bytes(static_cast<std::uint16_t>(i + 1)) + number_bytes(num_of_topic_[i]);
  }
  return number_bytes(num_messages_) + number_bytes(static_cast<std::uint16_t>(schema_of_.size())) +
         number_bytes(static_cast<std::uint32_t>(num_of_topic_.size())) +
         number_bytes(std::uint32_t{0}) + number_bytes(std::uint32_t{0}) +
         number_bytes(static_cast<std::uint32_t>(chunks_.size())) + number_bytes(first_ns_) +
         number_bytes(last_ns_) + text_bytes(counts);
}

void McapWriter::finish() {
  finish_chunk();
  put_record(kDataEnd, number_bytes(std::uint32_t{0}));
  const std::uint64_t summary = position_;
  put(topics_);
  put_record(kStatistics, statistics());
  for (const ChunkPlace& chunk : chunks_) {
    std::string indexes;
    for (const auto& [topic, offset] : chunk.indexes)
      indexes += number_bytes(topic) + number_bytes(offset);
    put_record(kChunkIndex, number_bytes(chunk.first_ns) + number_bytes(chunk.last_ns) +
                                number_bytes(chunk.offset) + number_bytes(chunk.size) +
                                text_bytes(indexes) + number_bytes(chunk.index_size) +
                                text_bytes("zstd") + number_bytes(chunk.packed_size) +
                                number_bytes(chunk.content_size));
  }
  // 0: neither summary offsets nor a checksum of the summary.
  put_record(kFooter, number_bytes(summary) + number_bytes(std::uint64_t{0}) +
                          number_bytes(std::uint32_t{0}));
  put(kMagic);
  out_.flush();
}

std::unique_ptr<RecordFormat> make_mcap_format() { return std::make_unique<McapFormat>(); }

}  // namespace orchard::io
