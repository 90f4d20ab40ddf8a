// SPDX-License-Identifier: BSD-3-Clause
#include "io/recording/rawlog.hpp"

#include <fcntl.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CObservation.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <exception>
#include <filesystem>
#include <new>
#include <stdexcept>

#include "io/file_error.hpp"
#include "io/memory_limit.hpp"
#include "io/recording/rawlog_collector.hpp"

namespace orchard::io {
namespace {

using namespace mrpt::obs;

/// Reads the file once to verify the checksum of a compressed file, which MRPT does not check.
/// Returns the uncompressed size in bytes.
std::uint64_t checked_size(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) {
    throw FileError(path + " is not a file; give an MRPT rawlog");
  }
  const gzFile file = ::gzopen(path.c_str(), "rb");
  if (file == nullptr) throw FileError(path + " cannot be opened; give a readable rawlog");
  std::vector<char> buffer(std::size_t{1} << 18);
  std::uint64_t size = 0;
  int count = 0;
  while ((count = ::gzread(file, buffer.data(), static_cast<unsigned>(buffer.size()))) > 0) {
    size += static_cast<std::uint64_t>(count);
  }
  int code = Z_OK;
  ::gzerror(file, &code);
  ::gzclose(file);
  if (count < 0 || code == Z_BUF_ERROR) {
    throw FileError(path + ": damaged or truncated (decompression failed); copy it again");
  }
  if (size == 0) throw FileError(path + " is empty; give an MRPT rawlog");
  return size;
}

void add(const mrpt::serialization::CSerializable::Ptr& object, RawlogCollector& collector) {
  if (!object) return;
  if (std::dynamic_pointer_cast<CObservationComment>(object)) return;
  if (const auto frame = std::dynamic_pointer_cast<CSensoryFrame>(object)) {
    collector.add(*frame);
  } else if (const auto actions = std::dynamic_pointer_cast<CActionCollection>(object)) {
    collector.add(*actions);
  } else if (const auto observation = std::dynamic_pointer_cast<CObservation>(object)) {
    collector.add(*observation);
  } else {
    collector.ignore(object->GetRuntimeClass()->className);
  }
}

void read_objects(const std::string& path, std::uint64_t size, RawlogCollector& collector) {
  std::uint64_t position = 0;
  try {
    mrpt::io::CFileGZInputStream stream(path);
    auto archive = mrpt::serialization::archiveFrom(stream);
    while (position < size) {
      add(archive.ReadObject(), collector);
      const std::uint64_t end = stream.getPosition();
      if (end <= position) throw std::runtime_error("the data is incomplete");
      position = end;
    }
  } catch (const FileError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw FileError(path + ": damaged at byte " + std::to_string(position) +
                    " (an object is larger than the file); copy it again");
  } catch (const std::exception& error) {
    const std::string reason = error.what();
    constexpr std::size_t kShownBytes = 200;  // MRPT appends its call stack
    throw FileError(path + ": cannot be read at byte " + std::to_string(position) + " (" +
                    reason.substr(0, std::min(reason.find('\n'), kShownBytes)) +
                    "); give a complete MRPT rawlog");
  }
}

/// Runs in a child process; reports an error through the pipe, or nothing.
[[noreturn]] void try_in_child(const std::string& path, std::uint64_t size, int pipe_end) {
  constexpr std::uint64_t kSpareBytes = std::uint64_t{2} << 30;
  const int null = ::open("/dev/null", O_WRONLY | O_CLOEXEC);  // MRPT prints to stdout and stderr
  if (null >= 0) {
    ::dup2(null, STDOUT_FILENO);
    ::dup2(null, STDERR_FILENO);
  }
  std::string mistake;
  try {
    const MemoryLimit limit(kSpareBytes + 8 * size);
    RawlogCollector collector(path);
    read_objects(path, size, collector);
  } catch (const std::exception& error) {
    mistake = error.what();
  }
  const bool is_written =
      ::write(pipe_end, mistake.data(), mistake.size()) == static_cast<ssize_t>(mistake.size());
  ::_exit(is_written ? 0 : 1);
}

/// Reads the file in a child process first, because MRPT crashes on some damage (a class name
/// changed to another). Throws FileError if the child crashes or reports an error.
void require_readable(const std::string& path, std::uint64_t size) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    throw FileError(path + ": the check of the file could not be started (pipe)");
  const pid_t child = ::fork();
  if (child == 0) try_in_child(path, size, ends[1]);
  ::close(ends[1]);
  std::string mistake;
  char buffer[4096];
  for (ssize_t count = 0; child > 0 && ((count = ::read(ends[0], buffer, sizeof(buffer))) > 0 ||
                                        (count < 0 && errno == EINTR));) {
    if (count > 0) mistake.append(buffer, static_cast<std::size_t>(count));
  }
  ::close(ends[0]);
  if (child < 0) throw FileError(path + ": the check of the file could not be started (process)");
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!mistake.empty()) throw FileError(mistake);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw FileError(path + ": damaged so that MRPT cannot read it; copy it again");
  }
}

}  // namespace

RawlogContent read_rawlog(const std::string& path) {
  const std::uint64_t size = checked_size(path);
  require_readable(path, size);
  RawlogCollector collector(path);
  read_objects(path, size, collector);
  RawlogContent content = collector.take();
  if (content.messages.empty()) {
    std::string found;
    for (const auto& [name, count] : content.ignored) {
      found += (found.empty() ? "" : ", ") + std::to_string(count) + " " + name;
    }
    throw FileError(path + " has no usable observation, only " +
                    (found.empty() ? "comments" : found));
  }
  return content;
}

}  // namespace orchard::io
