// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/corrections_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "io/atomic_file.hpp"
#include "io/file_error.hpp"

namespace orchard::io {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxBytes = std::size_t{64} << 20;

std::string path_in(const std::string& folder) {
  return (fs::path(folder) / kCorrectionsFile).string();
}

[[noreturn]] void fail(const std::string& path, const char* what) {
  const int error = errno;
  throw FileError(path + ": cannot " + what + " (" + std::strerror(error) + ")" +
                  (error == EACCES || error == EROFS ? "; check that you may write there" : ""));
}

/// The file, open and exclusively locked during the lifetime of this object.
class LockedFile {
 public:
  explicit LockedFile(std::string path) : path_(std::move(path)) {
    // The file may have been replaced or removed while waiting for the lock: then try again.
    while (!open_and_lock()) ::close(fd_);
  }
  ~LockedFile() {
    if (is_empty()) ::unlink(path_.c_str());  // nothing was written
    ::close(fd_);
  }
  LockedFile(const LockedFile&) = delete;
  LockedFile& operator=(const LockedFile&) = delete;

  std::string text() const {
    struct stat status {};
    if (::fstat(fd_, &status) != 0) fail(path_, "be read");
    if (!S_ISREG(status.st_mode)) throw FileError(path_ + " is not a regular file; move it away");
    if (static_cast<std::size_t>(status.st_size) > kMaxBytes) {
      throw FileError(path_ + " is too large for a list of corrections; move it away");
    }
    std::string text(static_cast<std::size_t>(status.st_size), '\0');
    std::size_t size = 0;
    while (size < text.size()) {
      const ssize_t got =
          ::pread(fd_, text.data() + size, text.size() - size, static_cast<off_t>(size));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) fail(path_, "be read");
      if (got == 0) break;
      size += static_cast<std::size_t>(got);
    }
    text.resize(size);
    return text;
  }

  /// Replaces everything from `offset` on by `lines`, or leaves it unchanged when the disk is full.
  void write_from(std::size_t offset, const std::string& lines) {
    const auto end = static_cast<off_t>(offset);
    if (::ftruncate(fd_, end) != 0) fail(path_, "be written");
    try {
      write_fully(fd_, path_, lines.data(), lines.size());
      sync_file(fd_, path_);
    } catch (const FileError&) {
      (void)!::ftruncate(fd_, end);
      throw;
    }
  }

 private:
  bool open_and_lock() {
    fd_ = ::open(path_.c_str(), O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC | O_NONBLOCK, 0666);
    if (fd_ < 0) fail(path_, "be opened for writing");
    constexpr int kTries = 1000;
    constexpr useconds_t kPause_us = 10000;
    // On a file system without locks, none is used.
    for (int i = 0; ::flock(fd_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK; ++i) {
      if (i >= kTries) {
        ::close(fd_);
        throw FileError(path_ + ": locked by another program for ten seconds; stop that program");
      }
      ::usleep(kPause_us);
    }
    struct stat mine {
    }, there{};
    return ::fstat(fd_, &mine) == 0 && ::stat(path_.c_str(), &there) == 0 &&
           mine.st_ino == there.st_ino && mine.st_dev == there.st_dev;
  }
  bool is_empty() const {
    struct stat status {};
    return ::fstat(fd_, &status) == 0 && S_ISREG(status.st_mode) && status.st_size == 0;
  }

  std::string path_;
  int fd_ = -1;
};

}  // namespace

StoredCorrections read_corrections(const std::string& folder) {
  const std::string path = path_in(folder);
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) {
    if (errno == ENOENT || errno == ENOTDIR) return {};
    fail(path, "be read");
  }
  std::string text;
  char part[65536];
  ssize_t got = 0;
  while ((got = ::read(fd, part, sizeof(part))) > 0 || (got < 0 && errno == EINTR)) {
    if (got > 0) text.append(part, static_cast<std::size_t>(got));
    if (text.size() > kMaxBytes) break;
  }
  const int error = errno;
  ::close(fd);
  errno = error;
  if (got < 0) fail(path, "be read");
  if (text.size() > kMaxBytes) {
    throw FileError(path + " is too large for a list of corrections; move it away");
  }
  return parse_corrections(text, path);
}

std::vector<mapping::Correction> append_corrections(
    const std::string& folder,
    const std::function<std::vector<mapping::Correction>(const std::vector<mapping::Correction>&)>&
        make) {
  const std::string path = path_in(folder);
  LockedFile file(path);
  const std::string text = file.text();
  const StoredCorrections stored = parse_corrections(text, path);
  std::vector<mapping::Correction> added = make(stored.list);
  std::int32_t number = stored.list.empty() ? 0 : stored.list.back().number;
  std::string lines;
  for (mapping::Correction& c : added) {
    c.number = ++number;
    lines += correction_line(c);
  }
  parse_corrections(lines, path);  // throws if the lines could not be read again
  if (!lines.empty()) file.write_from(text.size() - stored.num_unfinished_bytes, lines);
  return added;
}

}  // namespace orchard::io
