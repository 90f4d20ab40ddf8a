// SPDX-License-Identifier: BSD-3-Clause
#include "io/log/log_writer.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "io/atomic_file.hpp"
#include "io/file_error.hpp"
#include "io/log/log_format.hpp"
#include "io/log/log_reader.hpp"

namespace orchard::io {

struct LogWriter::Impl {
  static constexpr std::size_t kBufferBytes = std::size_t{1} << 18;

  explicit Impl(const std::string& path) : target(replaceable_path(path)), part(target + ".part") {
    fd = ::open(part.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (fd < 0) {
      throw FileError(path + ": cannot be written (" + std::strerror(errno) +
                      "); check that its folder exists and you may write there");
    }
    if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
      ::close(fd);
      throw FileError(path +
                      ": another process is writing this file; wait for it or give another name");
    }
    if (::ftruncate(fd, 0) != 0) {
      ::close(fd);
      throw FileError(path + ": cannot be written (" + std::strerror(errno) + ")");
    }
    buffer.reserve(2 * kBufferBytes);
  }

  ~Impl() {
    if (fd < 0) return;
    ::unlink(part.c_str());  // before the lock is released, so that it is still our file
    ::close(fd);
  }

  void flush() {
    write_fully(fd, target, buffer.data(), buffer.size());
    buffer.clear();
  }

  std::string target;
  std::string part;
  int fd = -1;
  std::int64_t num_events = 0;
  std::vector<std::uint8_t> buffer;
};

LogWriter::LogWriter(const std::string& path) : impl_(std::make_unique<Impl>(path)) {}
LogWriter::~LogWriter() = default;

void LogWriter::write(std::int64_t timestamp_us, std::string_view channel,
                      const std::vector<std::uint8_t>& data) {
  if (!impl_) throw FileError("write to a closed log");
  const bool printable =
      std::all_of(channel.begin(), channel.end(), [](char c) { return c > 0x20 && c < 0x7F; });
  if (channel.empty() || channel.size() > LogReader::kMaxChannelBytes || !printable) {
    throw FileError(impl_->target + ": \"" + std::string(channel) +
                    "\" is not a channel name: it must have 1 to 63 printable characters");
  }
  if (LogEventHeader::kBytes + channel.size() + data.size() > LogReader::kMaxEventBytes) {
    throw FileError(impl_->target + ": a message of " + std::to_string(data.size()) + " bytes on " +
                    std::string(channel) + " is too large for a log");
  }
  LogEventHeader header;
  header.sync = LogEventHeader::kSyncWord;
  header.event_number = impl_->num_events;
  header.timestamp_us = timestamp_us;
  header.channel_bytes = static_cast<std::uint32_t>(channel.size());
  header.data_bytes = static_cast<std::uint32_t>(data.size());
  std::uint8_t bytes[LogEventHeader::kBytes];
  put_log_event_header(header, bytes);
  auto& buffer = impl_->buffer;
  buffer.insert(buffer.end(), bytes, bytes + sizeof(bytes));
  buffer.insert(buffer.end(), channel.begin(), channel.end());
  buffer.insert(buffer.end(), data.begin(), data.end());
  ++impl_->num_events;
  if (buffer.size() >= Impl::kBufferBytes) impl_->flush();
}

void LogWriter::close() {
  if (!impl_) return;
  impl_->flush();
  sync_file(impl_->fd, impl_->target);
  rename_durably(impl_->part, impl_->target);
  ::close(impl_->fd);
  impl_->fd = -1;
  impl_.reset();
}

}  // namespace orchard::io
