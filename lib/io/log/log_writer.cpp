// SPDX-License-Identifier: BSD-3-Clause
#include "io/log/log_writer.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

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
      throw SystemError(path + ": cannot be written (" + std::strerror(errno) +
                        "); check that its folder exists and you may write there");
    }
    if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
      ::close(fd);
      throw FileError(path +
                      ": another process is writing this file; wait for it or give another name");
    }
    if (::ftruncate(fd, 0) != 0) {
      ::close(fd);
      throw SystemError(path + ": cannot be written (" + std::strerror(errno) + ")");
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
  if (!is_channel_name(channel)) {
    throw FileError(impl_->target + ": \"" + std::string(channel) +
                    "\" is not a channel name: it must have 1 to 63 printable characters");
  }
  if (LogEventHeader::kBytes + channel.size() + data.size() > LogReader::kMaxEventBytes) {
    throw FileError(impl_->target + ": a message of " + std::to_string(data.size()) + " bytes on " +
                    std::string(channel) + " is too large for a log");
  }
  append_log_event(impl_->num_events, timestamp_us, channel, data.data(), data.size(),
                   impl_->buffer);
  ++impl_->num_events;
  if (impl_->buffer.size() >= Impl::kBufferBytes) impl_->flush();
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

LogRepair repair_log(const std::string& path, const std::string& out_path,
                     const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  std::error_code ignored;
  if (std::filesystem::equivalent(path, out_path, ignored)) {
    throw FileError(out_path + " is the input log; give another name for the output");
  }
  LogReader reader(path);  // opened before the output is created
  LogWriter writer(out_path);
  LogRepair repair;
  while (const auto event = reader.next()) {
    writer.write(event->timestamp_us, event->channel, event->data);
    ++repair.num_events;
    if (progress) progress(reader.position(), reader.file_size());
  }
  if (repair.num_events == 0) {
    throw FileError(path + " has no readable LCM event; give an LCM log");
  }
  repair.gaps = reader.gaps();
  for (const LogGap& gap : repair.gaps) repair.num_lost_bytes += gap.size;
  writer.close();
  return repair;
}

}  // namespace orchard::io
