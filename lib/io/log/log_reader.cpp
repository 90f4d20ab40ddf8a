// SPDX-License-Identifier: BSD-3-Clause
#include "io/log/log_reader.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

#include "io/file_error.hpp"
#include "io/log/log_format.hpp"

namespace orchard::io {
namespace {

constexpr std::size_t kSyncBytes = 4;
constexpr std::uint8_t kSync[kSyncBytes] = {0xED, 0xA1, 0xDA, 0x01};
constexpr std::size_t kSearchBytes = 1u << 16;

std::unique_ptr<std::istream> open_log(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (std::filesystem::is_directory(status)) {
    throw FileError(path + " is a folder, not an LCM log; give the log file in it");
  }
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    throw FileError(
        path + " is a pipe or device, but the log must be read twice; copy it to a file first");
  }
  errno = 0;
  auto file = std::make_unique<std::ifstream>(path, std::ios::binary);
  if (!*file) {
    throw FileError(path + " cannot be opened (" +
                    (errno != 0 ? std::strerror(errno) : "unknown reason") +
                    "); give an existing LCM log");
  }
  return file;
}

}  // namespace

LogReader::LogReader(const std::string& path) : LogReader(open_log(path), path) {}

LogReader::LogReader(std::unique_ptr<std::istream> stream, const std::string& name)
    : path_(name), window_(std::move(stream)), file_size_(window_.size()) {}

std::optional<LogEvent> LogReader::next() {
  while (position_ < window_.size()) {
    if (const auto size = believed_size(position_)) {
      LogEvent event = event_at(position_, *size);
      position_ += *size;
      ++num_events_;
      return event;
    }
    const auto resumed = find_plausible(position_ + 1);
    skip_to(resumed ? *resumed : file_size_);
  }
  if (position_ < file_size_) skip_to(file_size_);  // the file was truncated during reading
  return std::nullopt;
}

LogEvent LogReader::read_at(std::uint64_t offset) {
  const auto size = plausible_size(offset);
  if (!size) {
    throw FileError(path_ + " has no event at offset " + std::to_string(offset) +
                    " any more; it was changed while it was read");
  }
  return event_at(offset, *size);
}

std::optional<std::uint64_t> LogReader::plausible_size(std::uint64_t offset, bool sync_word) {
  const auto view = window_.at(offset, LogEventHeader::kBytes + kMaxChannelBytes);
  if (view.size < LogEventHeader::kBytes) return std::nullopt;
  const LogEventHeader header = parse_log_event_header(view.bytes);
  if (sync_word && header.sync != LogEventHeader::kSyncWord) return std::nullopt;
  if (header.channel_bytes > kMaxChannelBytes) return std::nullopt;
  if (header.event_bytes() > kMaxEventBytes) return std::nullopt;
  if (header.event_bytes() > window_.size() - offset) return std::nullopt;
  const auto* channel = reinterpret_cast<const char*>(view.bytes + LogEventHeader::kBytes);
  if (!is_channel_name({channel, header.channel_bytes})) return std::nullopt;
  return header.event_bytes();
}

std::optional<std::uint64_t> LogReader::find_plausible(std::uint64_t offset) {
  while (offset + LogEventHeader::kBytes <= window_.size()) {
    const auto view = window_.at(offset, kSearchBytes);
    if (view.size < kSyncBytes) break;
    const std::uint8_t* end = view.bytes + view.size;
    const std::uint8_t* found = std::search(view.bytes, end, kSync, kSync + kSyncBytes);
    if (found == end) {
      offset += view.size - (kSyncBytes - 1);  // a sync word may straddle the end
      continue;
    }
    offset += static_cast<std::uint64_t>(found - view.bytes);
    if (plausible_size(offset)) return offset;
    ++offset;
  }
  return std::nullopt;
}

/// Size of the event at `offset`, or none if the surrounding events show that its header is
/// damaged.
std::optional<std::uint64_t> LogReader::believed_size(std::uint64_t offset) {
  const auto size = plausible_size(offset);
  if (!size) return std::nullopt;
  const std::uint64_t end = offset + *size;
  // Copy the number: the calls below move the window.
  const std::int64_t next_number =
      static_cast<std::int64_t>(static_cast<std::uint64_t>(event_number_at(offset)) + 1);
  const bool followed = end == window_.size() || plausible_size(end).has_value();
  const bool numbered = end == window_.size() || (followed && event_number_at(end) == next_number);
  if (followed && numbered && end != window_.size()) return size;
  // A length that was damaged to a larger value covers the following event, and may even end at the
  // start of a later one. The event numbers reveal it: lcm-logger numbers events without gaps.
  const auto inner = find_plausible(offset + kSyncBytes);
  if (!inner || *inner >= end) return size;
  if (followed) {
    return event_number_at(*inner) == next_number ? std::nullopt : size;
  }
  // The following event may have lost only its sync word, and the data may only resemble an event.
  const auto successor = plausible_size(end, false);
  const bool successor_holds =
      successor && event_number_at(end) == next_number &&
      (end + *successor == window_.size() || plausible_size(end + *successor));
  return successor_holds ? size : std::nullopt;
}

/// `offset` must have a plausible header.
std::int64_t LogReader::event_number_at(std::uint64_t offset) {
  return parse_log_event_header(window_.at(offset, LogEventHeader::kBytes).bytes).event_number;
}

LogEvent LogReader::event_at(std::uint64_t offset, std::uint64_t size) {
  const auto view = window_.at(offset, static_cast<std::size_t>(size));
  if (view.size < size) {
    throw SystemError(path_ + " cannot be read at offset " + std::to_string(offset) +
                      "; the disk may be failing, or the file is being written");
  }
  const LogEventHeader header = parse_log_event_header(view.bytes);
  const std::uint8_t* channel = view.bytes + LogEventHeader::kBytes;
  const std::uint8_t* data = channel + header.channel_bytes;
  LogEvent event;
  event.offset = offset;
  event.event_number = header.event_number;
  event.timestamp_us = header.timestamp_us;
  event.channel.assign(reinterpret_cast<const char*>(channel), header.channel_bytes);
  event.data.assign(data, data + header.data_bytes);
  return event;
}

void LogReader::skip_to(std::uint64_t offset) {
  if (!gaps_.empty() && gaps_.back().offset + gaps_.back().size == position_) {
    gaps_.back().size += offset - position_;
  } else {
    gaps_.push_back({position_, offset - position_, path_});
  }
  position_ = offset;
}

}  // namespace orchard::io
