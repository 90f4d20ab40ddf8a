// SPDX-License-Identifier: BSD-3-Clause
#include "io/bag/record_bag.hpp"

#include <bzlib.h>
#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <numeric>
#include <utility>

#include "io/unpacking_budget.hpp"

namespace orchard::io {
namespace {

const char* const kOtherLength = "its length differs from the stated one";

std::string unpack_lz4(const std::uint8_t* data, std::size_t size, std::vector<std::uint8_t>& out) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)))
    return "lz4 cannot be initialised";
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(
      raw, LZ4F_freeDecompressionContext);
  std::size_t read = 0, written = 0;
  while (read < size) {
    std::size_t in = size - read, room = out.size() - written;
    const std::size_t hint =
        LZ4F_decompress(raw, out.data() + written, &room, data + read, &in, nullptr);
    if (LZ4F_isError(hint)) return std::string("damaged: ") + LZ4F_getErrorName(hint);
    read += in;
    written += room;
    if (hint == 0) return written == out.size() ? "" : kOtherLength;  // end of the frame
    if (in == 0 && room == 0) return kOtherLength;
  }
  return "truncated";
}

std::string unpack_bz2(const std::uint8_t* data, std::size_t size, std::vector<std::uint8_t>& out) {
  auto length = static_cast<unsigned>(out.size());
  // libbz2 takes a non-const pointer but does not write to it.
  auto* source = const_cast<char*>(reinterpret_cast<const char*>(data));
  const int code = BZ2_bzBuffToBuffDecompress(reinterpret_cast<char*>(out.data()), &length, source,
                                              static_cast<unsigned>(size), 0, 0);
  if (code == BZ_OUTBUFF_FULL || (code == BZ_OK && length != out.size())) return kOtherLength;
  return code == BZ_OK ? "" : "damaged (bz2 error " + std::to_string(code) + ")";
}

constexpr std::size_t kMaxChunkBytes = std::size_t{128} << 20;
constexpr std::size_t kMaxLosses = 100;
constexpr std::size_t kMaxTopics = 10000;
constexpr std::size_t kRecentChunks = 8;  // for topics whose times differ slightly
constexpr std::size_t kRecentBytes = std::size_t{64} << 20;  // and of these together
constexpr std::uint64_t kProgressSteps = 4096;               // records, or bytes of damage
constexpr std::size_t kHeadBytes = std::size_t{1} << 17;  // enough to determine any record's size

std::string at_byte(std::uint64_t place) { return "at byte " + std::to_string(place) + ": "; }

}  // namespace

std::string unpack(const std::string& compression, const std::uint8_t* data, std::size_t size,
                   std::vector<std::uint8_t>& unpacked) {
  if (compression.empty() || compression == "none") {
    if (size != unpacked.size()) return kOtherLength;
    if (size > 0) std::memcpy(unpacked.data(), data, size);
    return "";
  }
  if (compression == "lz4") return unpack_lz4(data, size, unpacked);
  if (compression == "bz2") return unpack_bz2(data, size, unpacked);
  if (compression == "zstd") {
    const std::size_t length = ZSTD_decompress(unpacked.data(), unpacked.size(), data, size);
    if (ZSTD_isError(length)) return std::string("damaged: ") + ZSTD_getErrorName(length);
    return length == unpacked.size() ? "" : kOtherLength;
  }
  return "compression " + compression.substr(0, 32) +
         ", which is not supported (bz2, lz4 and zstd are)";
}

bool is_zstd(const std::uint8_t* data, std::size_t size) {
  constexpr std::uint8_t kMagic[] = {0x28, 0xB5, 0x2F, 0xFD};
  return size >= sizeof(kMagic) && std::memcmp(data, kMagic, sizeof(kMagic)) == 0;
}

std::size_t zstd_size(const std::uint8_t* data, std::size_t size, std::size_t most_bytes) {
  const unsigned long long length = ZSTD_getFrameContentSize(data, size);
  if (length == ZSTD_CONTENTSIZE_ERROR || length == ZSTD_CONTENTSIZE_UNKNOWN) return 0;
  return length <= most_bytes ? static_cast<std::size_t>(length) : 0;
}

RecordBag::RecordBag(std::unique_ptr<std::istream> stream, std::unique_ptr<RecordFormat> format,
                     std::function<void()> on_progress)
    : window_(std::move(stream)),
      format_(std::move(format)),
      position_(format_->magic_bytes()),
      on_progress_(std::move(on_progress)) {}

void RecordBag::count_step() {
  if (++num_steps_ % kProgressSteps == 0) on_progress_();
}

std::optional<BagMessage> RecordBag::next() {
  while (true) {
    if (chunk_) {
      if (auto message = next_in_chunk()) return message;
      continue;
    }
    count_step();
    const std::uint64_t place = position_;
    const FileWindow::View head = window_.at(place, kHeadBytes);
    if (head.size == 0) return std::nullopt;
    const auto size = format_->record_size(head.bytes, head.size);
    if (!size) {
      go_on_behind_damage("no record starts here");
      continue;
    }
    if (*size == 0 || *size > window_.size() - place) {
      lose(at_byte(place) + "truncated: its last " + std::to_string(window_.size() - place) +
           " bytes are an incomplete record");
      position_ = window_.size();
      return std::nullopt;
    }
    const auto view = record_at(place);
    position_ = place + *size;
    if (!view) {
      lose(at_byte(place) + "a record of " + std::to_string(*size) + " bytes is too large");
      continue;
    }
    BagRecord record = format_->read(view->bytes, static_cast<std::size_t>(*size));
    if (const auto* damaged = std::get_if<DamagedRecord>(&record)) {
      position_ = place;
      go_on_behind_damage(damaged->why);
    } else if (const auto* topic = std::get_if<TopicRecord>(&record)) {
      add_topic(*topic);
    } else if (const auto* chunk = std::get_if<ChunkRecord>(&record)) {
      on_progress_();
      unpacked_bytes_ += chunk->unpacked_size;
      if (!is_plausibly_packed(window_.size(), unpacked_bytes_)) {
        lose(at_byte(place) + "what follows is not read, because the chunks unpack to over " +
             std::to_string(unpacked_bytes_ >> 20) + " MB: no recording packs so well");
        position_ = window_.size();
        return std::nullopt;
      }
      if (auto content = content_of(*chunk, place)) {
        chunk_ = Chunk{place, std::move(*content), 0};
      }
    } else if (const auto* message = std::get_if<MessageRecord>(&record)) {
      if (auto found = message_of(*message, {place, 0})) return found;
    } else if (std::holds_alternative<LastRecord>(record)) {
      position_ = window_.size();
      return std::nullopt;
    }
  }
}

std::optional<BagMessage> RecordBag::next_in_chunk() {
  while (chunk_->position < chunk_->content.size()) {
    count_step();
    const std::uint64_t within = chunk_->position;
    const std::uint8_t* bytes = chunk_->content.data() + within;
    const std::size_t left = chunk_->content.size() - within;
    const auto size = format_->record_size(bytes, left);
    BagRecord record = DamagedRecord{"no record starts here"};
    if (size && *size > 0 && *size <= left) {
      record = format_->read(bytes, static_cast<std::size_t>(*size));
      chunk_->position += *size;
    }
    if (const auto* damaged = std::get_if<DamagedRecord>(&record)) {
      lose("in the chunk " + at_byte(chunk_->place) + std::to_string(left) + " bytes after byte " +
           std::to_string(within) + " are damaged (" + damaged->why + ")");
      break;
    }
    if (const auto* topic = std::get_if<TopicRecord>(&record)) add_topic(*topic);
    if (const auto* message = std::get_if<MessageRecord>(&record)) {
      if (auto found = message_of(*message, {chunk_->place, within})) return found;
    }
  }
  chunk_.reset();
  return std::nullopt;
}

std::optional<BagMessage> RecordBag::at(const BagPlace& place) {
  const auto known = std::find_if(recent_.begin(), recent_.end(),
                                  [&](const Chunk& c) { return c.place == place.record; });
  if (known == recent_.end()) {
    const auto view = record_at(place.record);
    if (!view) return std::nullopt;
    BagRecord record = format_->read(view->bytes, view->size);
    if (const auto* message = std::get_if<MessageRecord>(&record)) {
      return message_of(*message, place);
    }
    const auto* chunk = std::get_if<ChunkRecord>(&record);
    if (chunk == nullptr) return std::nullopt;
    auto content = content_of(*chunk, place.record);
    if (!content) return std::nullopt;
    keep_recent({place.record, std::move(*content), 0});
  } else {
    std::rotate(recent_.begin(), known, known + 1);
  }
  const std::vector<std::uint8_t>& content = recent_.front().content;
  if (place.within >= content.size()) return std::nullopt;
  const std::uint8_t* bytes = content.data() + place.within;
  const std::size_t left = content.size() - place.within;
  const auto size = format_->record_size(bytes, left);
  if (!size || *size == 0 || *size > left) return std::nullopt;
  BagRecord record = format_->read(bytes, static_cast<std::size_t>(*size));
  const auto* message = std::get_if<MessageRecord>(&record);
  return message ? message_of(*message, place) : std::nullopt;
}

void RecordBag::keep_recent(Chunk chunk) {
  recent_.push_front(std::move(chunk));
  const auto bytes = [this] {
    return std::accumulate(recent_.begin(), recent_.end(), std::size_t{0},
                           [](std::size_t sum, const Chunk& c) { return sum + c.content.size(); });
  };
  while (recent_.size() > 1 && (recent_.size() > kRecentChunks || bytes() > kRecentBytes)) {
    recent_.pop_back();
  }
}

std::optional<FileWindow::View> RecordBag::record_at(std::uint64_t place) {
  const FileWindow::View head = window_.at(place, kHeadBytes);
  const auto size = format_->record_size(head.bytes, head.size);
  if (!size || *size == 0 || *size > kMaxChunkBytes || *size > window_.size() - place) {
    return std::nullopt;
  }
  FileWindow::View view = window_.at(place, static_cast<std::size_t>(*size));
  if (view.size < *size) return std::nullopt;
  view.size = static_cast<std::size_t>(*size);
  return view;
}

std::optional<BagMessage> RecordBag::message_of(const MessageRecord& record,
                                                const BagPlace& place) {
  const auto topic = topic_of_id_.find(record.topic_id);
  if (topic == topic_of_id_.end()) {
    lose("messages of number " + std::to_string(record.topic_id) + ", whose topic is not defined");
    return std::nullopt;
  }
  if (record.size > kMaxMessageBytes) {
    lose(at_byte(place.record) + "a message of more than 64 MB");
    return std::nullopt;
  }
  return BagMessage{topic->second, record.utime, place, record.data, record.size};
}

void RecordBag::add_topic(const TopicRecord& record) {
  if (topic_of_id_.count(record.id) > 0 || topic_of_id_.size() >= kMaxTopics) return;
  // Each publisher of a topic has an id of its own.
  const auto same = std::find_if(topics_.begin(), topics_.end(), [&](const BagTopic& topic) {
    return topic.name == record.topic.name && topic.type == record.topic.type &&
           topic.wire == record.topic.wire && topic.is_known_wire == record.topic.is_known_wire;
  });
  topic_of_id_[record.id] = static_cast<std::size_t>(same - topics_.begin());
  if (same == topics_.end()) topics_.push_back(record.topic);
}

std::optional<std::vector<std::uint8_t>> RecordBag::content_of(const ChunkRecord& chunk,
                                                               std::uint64_t place) {
  if (chunk.unpacked_size > kMaxChunkBytes) {
    lose(at_byte(place) + "a chunk of more than 128 MB");
    return std::nullopt;
  }
  if (!is_plausibly_packed(chunk.size, chunk.unpacked_size)) {
    lose(at_byte(place) + "a chunk of " + std::to_string(chunk.size) + " bytes that unpacks to " +
         std::to_string(chunk.unpacked_size) + ": no recording packs so well");
    return std::nullopt;
  }
  std::vector<std::uint8_t> content(static_cast<std::size_t>(chunk.unpacked_size));
  std::string mistake = unpack(chunk.compression, chunk.data, chunk.size, content);
  if (mistake.empty() && chunk.crc != 0 &&
      crc32_z(0, content.data(), content.size()) != chunk.crc) {
    mistake = "its checksum is wrong";
  }
  if (mistake.empty()) return content;
  lose(at_byte(place) + "a chunk of " + std::to_string(chunk.size) + " bytes: " + mistake);
  return std::nullopt;
}

void RecordBag::go_on_behind_damage(const std::string& why) {
  const std::uint64_t begin = position_;
  std::uint64_t place = begin + 1;
  for (; place < window_.size(); ++place) {
    count_step();
    const FileWindow::View view = window_.at(place, 512);
    if (format_->begins_chunk(view.bytes, view.size)) break;
  }
  position_ = std::min(place, window_.size());
  lose(at_byte(begin) + std::to_string(position_ - begin) + " bytes are damaged (" + why + ")");
}

void RecordBag::lose(const std::string& what) {
  const bool is_known = std::find(losses_.begin(), losses_.end(), what) != losses_.end();
  if (!is_known && losses_.size() < kMaxLosses) losses_.push_back(what);
}

}  // namespace orchard::io
