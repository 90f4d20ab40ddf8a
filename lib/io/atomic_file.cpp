// SPDX-License-Identifier: BSD-3-Clause
#include "io/atomic_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "io/file_error.hpp"

namespace orchard::io {
namespace {

/// Of a text that is there as a whole.
constexpr std::size_t kPieceBytes = std::size_t{1} << 20;

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, const char* what, int error) {
  std::string advice;
  if (error == ENOSPC || error == EDQUOT) advice = "; free disk space and try again";
  if (error == EACCES || error == EPERM || error == EROFS) {
    advice = "; choose a folder in which you may write";
  }
  if (error == ENOENT) advice = "; create its folder first";
  throw SystemError(path + ": cannot " + what + " (" + std::strerror(error) + ")" + advice);
}

class Descriptor {
 public:
  Descriptor(const std::string& path, int flags)
      : fd_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

}  // namespace

std::string read_file(const std::string& path, std::size_t bytes_max, const std::string& advice) {
  const Descriptor file(path, O_RDONLY);
  std::string text;
  ssize_t got = file.get() < 0 ? -1 : 1;
  while (got > 0 && text.size() <= bytes_max) {
    const std::size_t size = text.size();
    text.resize(std::min(size + kPieceBytes, bytes_max + 1));
    do {
      got = ::read(file.get(), text.data() + size, text.size() - size);
    } while (got < 0 && errno == EINTR);
    text.resize(size + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  }
  if (got < 0) {
    throw FileError(path + ": cannot be read (" + std::strerror(errno) + "); " + advice);
  }
  if (text.size() > bytes_max) {
    throw FileError(path + ": is larger than " + std::to_string(bytes_max >> 20) + " MiB; " +
                    advice);
  }
  return text;
}

void write_fully(int fd, const std::string& path, const void* bytes, std::size_t size) {
  const char* next = static_cast<const char*>(bytes);
  while (size > 0) {
    const ssize_t written = ::write(fd, next, size);
    if (written < 0) {
      if (errno == EINTR) continue;
      fail(path, "be written", errno);
    }
    next += written;
    size -= static_cast<std::size_t>(written);
  }
}

void sync_file(int fd, const std::string& path) {
  if (::fsync(fd) != 0) fail(path, "be synced to the disk", errno);
}

void rename_durably(const std::string& from, const std::string& to) {
  if (std::rename(from.c_str(), to.c_str()) != 0) fail(to, "be replaced", errno);
  const fs::path folder = fs::path(to).parent_path();
  const Descriptor directory(folder.empty() ? "." : folder.string(), O_RDONLY | O_DIRECTORY);
  // Some file systems do not support syncing folders; the file has been replaced anyway.
  if (directory.get() >= 0) (void)::fsync(directory.get());
}

std::string replaceable_path(const std::string& path) {
  std::error_code error;
  if (path.empty()) throw FileError("the file name is empty; give one");
  const fs::file_status status = fs::status(path, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw FileError(path + (fs::is_directory(status) ? " is a folder" : " is not a regular file") +
                    " and is not replaced; give the name of a file");
  }
  if (!fs::is_symlink(fs::symlink_status(path, error))) return path;
  const fs::path target = fs::weakly_canonical(path, error);
  if (error) throw FileError(path + ": this link cannot be followed (" + error.message() + ")");
  return target.string();
}

FileReplacement::~FileReplacement() {
  std::error_code ignored;
  for (const Entry& entry : entries_) fs::remove(entry.temporary, ignored);
}

std::string FileReplacement::temporary_for(const std::string& path) {
  static std::atomic<unsigned> counter{0};
  const fs::path target = replaceable_path(path);
  const std::string name = "." + target.stem().string() + "." + std::to_string(::getpid()) + "-" +
                           std::to_string(counter++) + target.extension().string();
  const std::string temporary = (target.parent_path() / name).string();
  std::error_code ignored;
  fs::remove(temporary, ignored);  // left by a killed process with the same process id
  entries_.push_back({target.string(), temporary});
  return temporary;
}

void FileReplacement::write(const std::string& path, std::string_view content) {
  write(path, [&content](std::string& piece) {
    piece.assign(content.substr(0, kPieceBytes));
    content.remove_prefix(piece.size());
    return !piece.empty();
  });
}

void FileReplacement::write(const std::string& path, const TextPieces& next) {
  const std::string temporary = temporary_for(path);
  const Descriptor file(temporary, O_WRONLY | O_CREAT | O_EXCL);
  if (file.get() < 0) fail(path, "be written", errno);
  std::string piece;
  while (next(piece)) write_fully(file.get(), path, piece.data(), piece.size());
}

void FileReplacement::commit() {
  for (const Entry& entry : entries_) {
    const Descriptor file(entry.temporary, O_RDONLY);
    if (file.get() < 0) fail(entry.path, "be written", errno);
    sync_file(file.get(), entry.path);
  }
  for (const Entry& entry : entries_) rename_durably(entry.temporary, entry.path);
  entries_.clear();
}

void write_file_atomically(const std::string& path, std::string_view content) {
  FileReplacement replacement;
  replacement.write(path, content);
  replacement.commit();
}

void replace_file_atomically(const std::string& path,
                             const std::function<void(const std::string& temporary)>& write) {
  FileReplacement replacement;
  write(replacement.temporary_for(path));
  replacement.commit();
}

}  // namespace orchard::io
