// SPDX-License-Identifier: BSD-3-Clause
//
// rosbag 2.0, by the ROS wiki ("Bags/Format/2.0"): each record has a header, which is a list of
// name=value, and data; chunks contain connections and messages.
#include <map>
#include <utility>

#include "io/bag/record_bag.hpp"

namespace orchard::io {
namespace {

constexpr std::uint32_t kMaxHeaderBytes = 1u << 16;

enum Operation : std::uint8_t {
  kMessage = 0x02,
  kChunk = 0x05,
  kConnection = 0x07,
};

/// The fields of a record's header.
class HeaderFields {
 public:
  HeaderFields(const std::uint8_t* bytes, std::size_t size) {
    ByteFields fields(bytes, size);
    while (fields.ok() && fields.left() > 0) {
      const std::string field = fields.text();
      const std::size_t equals = field.find('=');
      if (!fields.ok() || equals == std::string::npos) return;
      values_[field.substr(0, equals)] = field.substr(equals + 1);
    }
    is_sound_ = fields.ok();
  }

  template <class T>
  std::optional<T> number(const char* name) const {
    const auto found = values_.find(name);
    if (found == values_.end() || found->second.size() != sizeof(T)) return std::nullopt;
    T value;
    std::memcpy(&value, found->second.data(), sizeof(T));
    return value;
  }
  std::string text(const char* name) const {
    const auto found = values_.find(name);
    return found != values_.end() ? found->second : std::string();
  }
  bool is_sound() const { return is_sound_; }

 private:
  std::map<std::string, std::string> values_;
  bool is_sound_ = false;
};

class RosbagFormat : public RecordFormat {
 public:
  std::size_t magic_bytes() const override { return 13; }

  std::optional<std::uint64_t> record_size(const std::uint8_t* bytes,
                                           std::size_t size) const override {
    ByteFields fields(bytes, size);
    const auto header_size = fields.number<std::uint32_t>();
    if (!fields.ok()) return 0;
    // Every header contains its operation: "op=" and a byte.
    if (header_size < 8 || header_size > kMaxHeaderBytes) return std::nullopt;
    fields.take(header_size);
    const auto data_size = fields.number<std::uint32_t>();
    if (!fields.ok()) return 0;
    return std::uint64_t{8} + header_size + data_size;
  }

  bool begins_chunk(const std::uint8_t* bytes, std::size_t size) const override {
    ByteFields fields(bytes, size);
    const auto header_size = fields.number<std::uint32_t>();
    if (!fields.ok() || header_size > 256 || header_size > fields.left()) return false;
    const HeaderFields header(fields.take(header_size), header_size);
    return header.is_sound() && header.number<std::uint8_t>("op") == std::uint8_t{kChunk} &&
           header.number<std::uint32_t>("size");
  }

  BagRecord read(const std::uint8_t* bytes, std::size_t size) override {
    ByteFields fields(bytes, size);
    const auto header_size = fields.number<std::uint32_t>();
    const HeaderFields header(fields.take(header_size), header_size);
    const auto data_size = fields.number<std::uint32_t>();
    const std::uint8_t* data = fields.take(data_size);
    const auto operation = header.number<std::uint8_t>("op");
    if (!fields.ok() || !header.is_sound() || !operation) {
      return DamagedRecord{"a record with an invalid header"};
    }
    if (*operation == kConnection) return read_connection(header, data, data_size);
    if (*operation == kMessage) return read_message(header, data, data_size);
    if (*operation == kChunk) return read_chunk(header, data, data_size);
    return OtherRecord{};
  }

 private:
  static BagRecord read_connection(const HeaderFields& header, const std::uint8_t* data,
                                   std::size_t size) {
    const auto id = header.number<std::uint32_t>("conn");
    if (!id) return DamagedRecord{"a connection without a number"};
    TopicRecord record;
    record.id = *id;
    record.topic.name = header.text("topic");
    record.topic.type = HeaderFields(data, size).text("type");
    return record;
  }

  static BagRecord read_message(const HeaderFields& header, const std::uint8_t* data,
                                std::size_t size) {
    const auto id = header.number<std::uint32_t>("conn");
    const auto time = header.number<std::uint64_t>("time");
    if (!id || !time) return DamagedRecord{"a message without a connection or time"};
    MessageRecord record;
    record.topic_id = *id;
    const auto seconds = static_cast<std::int64_t>(*time & 0xFFFFFFFFu);
    const auto nanoseconds = static_cast<std::int64_t>(*time >> 32);
    record.utime = seconds * 1'000'000 + nanoseconds / 1000;
    record.data = data;
    record.size = size;
    return record;
  }

  static BagRecord read_chunk(const HeaderFields& header, const std::uint8_t* data,
                              std::size_t size) {
    const auto unpacked_size = header.number<std::uint32_t>("size");
    if (!unpacked_size) return DamagedRecord{"a chunk without a size"};
    ChunkRecord record;
    record.compression = header.text("compression");
    record.unpacked_size = *unpacked_size;
    record.data = data;
    record.size = size;
    return record;
  }
};

}  // namespace

std::unique_ptr<RecordFormat> make_rosbag_format() { return std::make_unique<RosbagFormat>(); }

}  // namespace orchard::io
