// SPDX-License-Identifier: BSD-3-Clause
//
// MCAP, by its specification (mcap.dev/spec): each record has an opcode, a length of eight bytes,
// and content; chunks contain schemas, channels and messages.
#include <map>
#include <utility>

#include "io/bag/byte_fields.hpp"
#include "io/bag/record_format.hpp"

namespace orchard::io {
namespace {

constexpr std::size_t kHeadBytes = 9;
constexpr std::int64_t kNanosecondsPerMicrosecond = 1000;

enum Opcode : std::uint8_t {
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kDataEnd = 0x0F,
};

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

std::unique_ptr<RecordFormat> make_mcap_format() { return std::make_unique<McapFormat>(); }

}  // namespace orchard::io
