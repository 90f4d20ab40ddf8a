// SPDX-License-Identifier: BSD-3-Clause
#include "io/journal.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

#include "io/atomic_file.hpp"
#include "io/byte_fields.hpp"
#include "io/file_error.hpp"

namespace orchard::io {
namespace {

constexpr char kJournalMagic[] = "ORCHJRNL";
constexpr std::uint32_t kVersion = 2;
constexpr std::size_t kJournalHeaderBytes = 24;
constexpr std::uint32_t kBlockMark = 0x314B424Au;  // "JBK1"
constexpr std::size_t kBlockHeaderBytes = 16;
/// Size at which a block is closed; a single record may be as large as the largest message.
constexpr std::size_t kBlockMax = std::size_t{1} << 20;
constexpr std::size_t kBlockReadMax = std::size_t{32} << 20;
/// Fast, also on the pictures of an album, which cannot be compressed further.
constexpr int kCompressionLevel = 1;
/// Max number of blocks waiting while the disk cannot be written: 64 MB, about a quarter of an
/// hour.
constexpr std::size_t kWaitingMax = 64;

std::string record_of(std::uint8_t kind, std::string_view bytes) {
  return number_bytes(kind) + text_bytes(bytes);
}

std::uint32_t crc_of(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      ::crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::string header_of(std::int64_t identity) {
  const std::string header = kJournalMagic + number_bytes(kVersion) + number_bytes(identity);
  return header + number_bytes(crc_of(header));
}

/// Compares a header with the expected one and states the difference.
JournalReading judge_header(const std::string& header, std::int64_t identity) {
  JournalReading reading;
  if (header == header_of(identity)) {
    reading.state = JournalReading::State::kWhole;
    reading.num_good_bytes = kJournalHeaderBytes;
    return reading;
  }
  ByteFields fields(header);
  const bool is_journal = header.compare(0, 8, kJournalMagic) == 0 && fields.take(8) != nullptr;
  const auto version = fields.number<std::uint32_t>();
  fields.number<std::int64_t>();  // the other identity
  reading.state = JournalReading::State::kDamaged;
  if (!is_journal) {
    reading.reason = "it has no header of a journal";
  } else if (fields.number<std::uint32_t>() != crc_of({header.data(), 20})) {
    reading.reason = "its header is damaged";
  } else if (version != kVersion) {
    reading.reason =
        "it has format " + std::to_string(version) + " instead of " + std::to_string(kVersion);
  } else {
    reading.state = JournalReading::State::kOtherMaker;
  }
  return reading;
}

/// Passes the records of an inflated block to the hook; false if their sizes are inconsistent.
bool hand_over(std::string_view records, JournalReading& reading,
               const JournalRecordHook& on_record) {
  ByteFields fields(records);
  while (fields.left() > 0) {
    const auto kind = fields.number<std::uint8_t>();
    const std::size_t size = fields.number<std::uint32_t>();
    const std::uint8_t* bytes = fields.take(size);
    if (!fields.ok()) return false;
    const std::string_view record(reinterpret_cast<const char*>(bytes), size);
    if (kind == Journal::kGapKind) {
      if (size != sizeof(std::uint32_t)) return false;
      reading.num_missing += ByteFields(record).number<std::uint32_t>();
    } else {
      ++reading.num_records;
      if (on_record) on_record(kind, record);
    }
  }
  return true;
}

struct BlockHeader {
  explicit BlockHeader(std::string_view bytes) {
    ByteFields fields(bytes);
    mark = fields.number<std::uint32_t>();
    inflated_bytes = fields.number<std::uint32_t>();
    stored_bytes = fields.number<std::uint32_t>();
    crc = fields.number<std::uint32_t>();
  }
  bool is_believed() const {
    return mark == kBlockMark && stored_bytes <= kBlockReadMax && inflated_bytes <= kBlockReadMax;
  }
  std::uint32_t mark, inflated_bytes, stored_bytes, crc;
};

/// Checks a block and passes its records to the hook; false if it is damaged.
bool use_block(const BlockHeader& header, const std::string& stored, JournalReading& reading,
               const JournalRecordHook& on_record) {
  if (crc_of(stored) != header.crc) return false;
  std::string records(header.inflated_bytes, '\0');
  if (ZSTD_decompress(records.data(), records.size(), stored.data(), stored.size()) !=
      records.size()) {
    return false;
  }
  return hand_over(records, reading, on_record);
}

bool is_zero_to_the_end(std::istream& file, std::uint64_t offset) {
  file.clear();
  file.seekg(static_cast<std::streamoff>(offset));
  char c = 0;
  while (file.get(c)) {
    if (c != 0) return false;
  }
  return true;
}

}  // namespace

JournalReading read_journal(const std::string& path, std::int64_t identity,
                            const JournalRecordHook& on_record) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return {};
  if (!std::filesystem::is_regular_file(path, error)) {
    throw FileError(path + " is not a regular file; give another folder");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) throw FileError(path + ": cannot be read (" + std::strerror(errno) + ")");
  const std::uint64_t file_size = std::filesystem::file_size(path, error);
  if (file_size < kJournalHeaderBytes) return {};  // killed before the first commit
  std::string header(kJournalHeaderBytes, '\0');
  file.read(header.data(), kJournalHeaderBytes);
  JournalReading reading = judge_header(header, identity);
  std::string block_header(kBlockHeaderBytes, '\0'), stored;
  while (reading.state == JournalReading::State::kWhole && reading.num_good_bytes < file_size) {
    const std::uint64_t offset = reading.num_good_bytes;
    const std::uint64_t left = file_size - offset;
    bool holds = false;
    std::uint64_t end = file_size;
    if (left >= kBlockHeaderBytes) {
      file.read(block_header.data(), kBlockHeaderBytes);
      const BlockHeader block(block_header);
      end = offset + kBlockHeaderBytes + (block.is_believed() ? block.stored_bytes : 0);
      if (block.is_believed() && end <= file_size) {
        stored.resize(block.stored_bytes);
        file.read(stored.data(), static_cast<std::streamsize>(stored.size()));
        holds = file && use_block(block, stored, reading, on_record);
      }
    }
    if (holds) {
      reading.num_good_bytes = end;
    } else {
      // A killed process leaves only the last block incomplete: cut off or filled with zeros.
      reading.num_torn_bytes = left;
      if (end < file_size && !is_zero_to_the_end(file, offset)) {
        reading.state = JournalReading::State::kDamaged;
        reading.reason = "the block at offset " + std::to_string(offset) + " is inconsistent";
      }
      break;
    }
  }
  return reading;
}

Journal::Journal(std::string path, std::int64_t identity, std::uint64_t num_good_bytes)
    : path_(std::move(path)), identity_(identity), size_(num_good_bytes) {
  fd_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (fd_ < 0) throw SystemError(path_ + ": cannot be written (" + std::strerror(errno) + ")");
  try {
    if (::ftruncate(fd_, static_cast<off_t>(size_)) != 0 || ::lseek(fd_, 0, SEEK_END) < 0) {
      throw SystemError(path_ + ": cannot be written (" + std::strerror(errno) + ")");
    }
    if (size_ == 0) write_header();
  } catch (const FileError&) {
    ::close(fd_);
    throw;
  }
}

Journal::~Journal() {
  if (fd_ >= 0) ::close(fd_);
}

void Journal::write_header() {
  const std::string header = header_of(identity_);
  if (::ftruncate(fd_, 0) != 0 || ::lseek(fd_, 0, SEEK_SET) < 0) {
    throw SystemError(path_ + ": cannot be written (" + std::strerror(errno) + ")");
  }
  write_fully(fd_, path_, header.data(), header.size());
  size_ = header.size();
}

void Journal::add(std::uint8_t kind, const void* bytes, std::size_t size) {
  const std::lock_guard lock(adding_);
  if (waiting_.empty() || waiting_.back().records.size() > kBlockMax) waiting_.emplace_back();
  if (waiting_.size() > kWaitingMax) {
    num_dropped_ += waiting_.front().count;
    waiting_.erase(waiting_.begin());
  }
  waiting_.back().records += record_of(kind, {static_cast<const char*>(bytes), size});
  ++waiting_.back().count;
}

void Journal::write_block(const std::string& records) {
  std::string block(kBlockHeaderBytes + ZSTD_compressBound(records.size()), '\0');
  const std::size_t size =
      ZSTD_compress(block.data() + kBlockHeaderBytes, block.size() - kBlockHeaderBytes,
                    records.data(), records.size(), kCompressionLevel);
  if (ZSTD_isError(size) != 0) throw SystemError(path_ + ": cannot be compressed");
  block.resize(kBlockHeaderBytes + size);
  block.replace(0, kBlockHeaderBytes,
                number_bytes(kBlockMark) +
                    number_bytes(static_cast<std::uint32_t>(records.size())) +
                    number_bytes(static_cast<std::uint32_t>(size)) +
                    number_bytes(crc_of({block.data() + kBlockHeaderBytes, size})));
  try {
    write_fully(fd_, path_, block.data(), block.size());
  } catch (const FileError&) {  // remove the partial block
    if (::ftruncate(fd_, static_cast<off_t>(size_)) == 0) ::lseek(fd_, 0, SEEK_END);
    throw;
  }
  size_ += block.size();
}

void Journal::commit() {
  const std::lock_guard alone(committing_);
  std::vector<Waiting> blocks;
  std::uint32_t num_dropped = 0;
  {
    const std::lock_guard lock(adding_);
    blocks.swap(waiting_);
    num_dropped = std::exchange(num_dropped_, 0);
  }
  if (blocks.empty()) return;
  std::size_t num_written = 0;
  try {
    if (size_ == 0) write_header();  // the disk was full at the start
    for (const Waiting& block : blocks) {
      write_block(num_dropped > 0 ? record_of(kGapKind, number_bytes(num_dropped)) + block.records
                                  : block.records);
      num_dropped = 0;
      ++num_written;
    }
  } catch (const FileError&) {  // they still wait
    const std::lock_guard lock(adding_);
    const auto left = blocks.begin() + static_cast<std::ptrdiff_t>(num_written);
    waiting_.insert(waiting_.begin(), std::make_move_iterator(left),
                    std::make_move_iterator(blocks.end()));
    num_dropped_ += num_dropped;
    throw;
  }
  if (::fdatasync(fd_) != 0) {
    throw SystemError(path_ + ": cannot be synced to the disk (" + std::strerror(errno) + ")");
  }
}

}  // namespace orchard::io
