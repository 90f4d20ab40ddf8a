// SPDX-License-Identifier: BSD-3-Clause
#include "io/log/log_recorder.hpp"

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

#include "io/atomic_file.hpp"
#include "io/file_error.hpp"
#include "io/folder.hpp"
#include "io/log/log_format.hpp"
#include "io/log/log_reader.hpp"

namespace orchard::io {
namespace {

constexpr std::size_t kBuffer_bytes = std::size_t{1} << 18;

std::string numbered(const std::string& stem, int number) {
  char text[16];
  std::snprintf(text, sizeof(text), "-%03d.lcm", number);
  return stem + text;
}

bool fits_a_log(std::string_view channel, std::size_t size) {
  return is_channel_name(channel) &&
         LogEventHeader::kBytes + channel.size() + size <= LogReader::kMaxEventBytes;
}

std::string megabytes(std::int64_t bytes) { return std::to_string(bytes / 1000000) + " MB"; }

}  // namespace

LogRecorder::LogRecorder(std::string stem, RecordingLimits limits)
    : stem_(std::move(stem)), limits_(limits) {
  const std::filesystem::path folder = std::filesystem::path(stem_).parent_path();
  if (!folder.empty()) make_folder(folder.string());
  if (!open_next()) throw SystemError(problem_);
  look_at_space();
}

LogRecorder::~LogRecorder() {
  flush();
  close_file();
}

bool LogRecorder::open_next() {
  const std::string path = numbered(stem_, next_number_);
  fileno_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666);
  if (fileno_ < 0) {
    problem_ = path + ": cannot be written (" + std::strerror(errno) + ")";
    return false;
  }
  path_ = path;
  ++next_number_;
  file_bytes_ = 0;
  num_in_file_ = 0;
  return true;
}

void LogRecorder::write(std::int64_t utime, std::string_view channel, const std::uint8_t* data,
                        std::size_t size) {
  if (fileno_ < 0 || is_space_short() || !fits_a_log(channel, size)) {
    ++num_dropped_;
    return;
  }
  append_log_event(num_in_file_, utime, channel, data, size, buffer_);
  ++num_in_file_;
  ++num_in_buffer_;
  if (buffer_.size() >= kBuffer_bytes) flush();
}

void LogRecorder::flush() {
  if (fileno_ < 0 || buffer_.empty()) return;
  try {
    write_fully(fileno_, path_, buffer_.data(), buffer_.size());
    file_bytes_ += static_cast<std::int64_t>(buffer_.size());
    num_written_ += num_in_buffer_;
  } catch (const FileError& error) {
    // A partial event would hide the following ones: truncate the file to its last complete buffer.
    problem_ = error.what();
    if (::ftruncate(fileno_, file_bytes_) != 0) close_file();
    num_dropped_ += num_in_buffer_;
  }
  num_in_buffer_ = 0;
  buffer_.clear();
}

void LogRecorder::close_file() {
  if (fileno_ < 0) return;
  ::fdatasync(fileno_);
  ::close(fileno_);
  fileno_ = -1;
  finished_.push_back({path_, std::exchange(file_bytes_, 0)});
}

std::int64_t LogRecorder::total_bytes() const {
  std::int64_t total = file_bytes_;
  for (const Segment& segment : finished_) total += segment.bytes;
  return total;
}

void LogRecorder::remove_oldest() {
  if (finished_.empty()) return;
  ::unlink(finished_.front().path.c_str());
  finished_.pop_front();
}

bool LogRecorder::is_space_short() const { return free_bytes_ < limits_.least_free_bytes; }

void LogRecorder::look_at_space() {
  struct statvfs disk {};
  const std::string folder = std::filesystem::path(stem_).parent_path().string();
  if (statvfs(folder.empty() ? "." : folder.c_str(), &disk) == 0) {
    free_bytes_ =
        static_cast<std::int64_t>(disk.f_bavail) * static_cast<std::int64_t>(disk.f_frsize);
  }
}

void LogRecorder::sync() {
  problem_.clear();
  flush();
  if (fileno_ >= 0) {
    // Start writing without waiting: a slow memory card must not delay the messages.
    sync_file_range(fileno_, 0, 0, SYNC_FILE_RANGE_WRITE);
    if (file_bytes_ >= limits_.split_bytes) close_file();
  }
  while (limits_.keep_bytes > 0 && !finished_.empty() && total_bytes() > limits_.keep_bytes) {
    remove_oldest();
  }
  look_at_space();
  while (limits_.keep_bytes > 0 && is_space_short() && !finished_.empty()) {
    remove_oldest();
    look_at_space();
  }
  if (fileno_ < 0) open_next();
  if (problem_.empty() && is_space_short()) {
    problem_ = "the disk of " + stem_ + " has " + megabytes(free_bytes_) + " free, of which " +
               megabytes(limits_.least_free_bytes) +
               " are reserved: recording is paused; free disk space";
  }
}

}  // namespace orchard::io
