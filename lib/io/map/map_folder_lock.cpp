// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/map_folder_lock.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <regex>
#include <utility>

#include "io/atomic_file.hpp"
#include "io/file_error.hpp"
#include "io/folder.hpp"

namespace orchard::io {
namespace {

namespace fs = std::filesystem;

/// Files written by write_map_folder() and `orchard map`.
bool is_map_file(const std::string& name) {
  static const std::regex kNames(
      "corrections\\.jsonl|map\\.(csv|gpkg|svg|png|pdf|html)|trajectory(_[0-9]+)?\\.csv|"
      "trajectory\\.tum|graph\\.json|(ids|left_out|names|plan|plan_rows)\\.csv|"
      "(summary|plan)\\.json|derived\\.lcm|album");
  return std::regex_match(name, kNames);
}

/// Modification time of a file as "20261122T084500Z".
std::string change_time(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return {};
  std::tm utc{};
  ::gmtime_r(&status.st_mtime, &utc);
  char text[32];
  std::strftime(text, sizeof(text), "%Y%m%dT%H%M%SZ", &utc);
  return text;
}

bool is_alive(long pid) { return ::kill(static_cast<pid_t>(pid), 0) == 0 || errno == EPERM; }

}  // namespace

MapFolderLock::MapFolderLock(std::string folder) : folder_(std::move(folder)) {
  make_folder(folder_, "choose another folder for the map");
  lock();
  try {
    remove_temporaries();  // first, because they may have filled the disk
    try_to_write();
  } catch (...) {
    ::close(fd_);
    throw;
  }
}

MapFolderLock::~MapFolderLock() { ::close(fd_); }

std::string MapFolderLock::file(const std::string& name) const {
  return (fs::path(folder_) / name).string();
}

void MapFolderLock::lock() {
  fd_ = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd_ < 0) throw SystemError(folder_ + ": cannot be read (" + std::strerror(errno) + ")");
  // On a file system without locks, none is used.
  if (::flock(fd_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(fd_);
    throw FileError(
        folder_ +
        ": another mapper is saving its map in this folder; stop it, or choose another folder");
  }
}

void MapFolderLock::try_to_write() const {
  FileReplacement trial;  // never committed: removed at once
  trial.write(file("trial.csv"), "id\n");
}

void MapFolderLock::remove_temporaries() {
  static const std::regex kTemporary("\\.([a-z_0-9]+)\\.([0-9]{1,9})-[0-9]+(\\.[a-z]+)");
  for (const std::string& name : folder_names(folder_)) {
    std::smatch part;
    if (!std::regex_match(name, part, kTemporary)) continue;
    const std::string target = part[1].str() + part[3].str();
    if (target != "trial.csv" && !is_map_file(target)) continue;
    const long pid = std::stol(part[2].str());
    // This process has none yet, so a file with its own process id is from an earlier process.
    if (pid != ::getpid() && is_alive(pid)) continue;
    std::error_code error;
    if (fs::remove(file(name), error)) ++num_removed_temporaries_;
  }
}

std::uint64_t MapFolderLock::free_bytes() const {
  std::error_code error;
  const fs::space_info space = fs::space(folder_, error);
  return error ? UINT64_MAX : static_cast<std::uint64_t>(space.available);
}

std::string MapFolderLock::set_aside(const std::vector<std::string>& more) {
  std::vector<std::string> names;
  std::string newest;
  for (const std::string& name : folder_names(folder_)) {
    if (!is_map_file(name) && std::count(more.begin(), more.end(), name) == 0) continue;
    names.push_back(name);
    newest = std::max(newest, change_time(file(name)));
  }
  if (names.empty()) return {};
  std::string aside = file("earlier_" + newest);
  for (int k = 2; fs::exists(aside); ++k) {
    aside = file("earlier_" + newest + "_" + std::to_string(k));
  }
  make_folder(aside);
  for (const std::string& name : names) {
    rename_durably(file(name), (fs::path(aside) / name).string());
  }
  return aside;
}

}  // namespace orchard::io
