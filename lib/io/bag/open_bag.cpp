// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "io/bag/bag_reader.hpp"
#include "io/bag/record_bag.hpp"
#include "io/bag/sqlite_bag.hpp"
#include "io/file_error.hpp"

namespace orchard::io {
namespace {

namespace fs = std::filesystem;

enum class Format { kNone, kRosbag, kMcap, kSqlite };

Format format_of(const std::string& path) {
  if (!fs::is_regular_file(path)) return Format::kNone;
  std::ifstream file(path, std::ios::binary);
  std::array<char, 16> begin{};
  file.read(begin.data(), begin.size());
  const std::string_view magic(begin.data(), static_cast<std::size_t>(file.gcount()));
  const auto is = [magic](std::string_view known) {
    return magic.substr(0, known.size()) == known;
  };
  if (is("#ROSBAG V2.0\n")) return Format::kRosbag;
  if (is("\x89MCAP0\r\n")) return Format::kMcap;
  if (is(std::string_view("SQLite format 3\0", 16))) return Format::kSqlite;
  return Format::kNone;
}

}  // namespace

bool is_bag(const std::string& path) { return format_of(path) != Format::kNone; }

std::unique_ptr<BagReader> open_bag(const std::string& path) {
  const Format format = format_of(path);
  if (format == Format::kNone) {
    throw FileError(path +
                    ": not a supported bag; give a rosbag 2.0, MCAP or sqlite3 (rosbag2) bag");
  }
  if (format == Format::kSqlite) return std::make_unique<SqliteBag>(path);
  auto file = std::make_unique<std::ifstream>(path, std::ios::binary);
  if (!*file) throw FileError(path + ": cannot be opened");
  return std::make_unique<RecordBag>(
      std::move(file), format == Format::kRosbag ? make_rosbag_format() : make_mcap_format());
}

std::vector<std::string> bag_files(const std::string& folder) {
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string path = entry.path().string();
    const std::string extension = entry.path().extension().string();
    if ((extension == ".zstd" || extension == ".zst") &&
        fs::exists(fs::path(folder) / "metadata.yaml")) {
      throw FileError(path + " is compressed as a file; decompress it first: zstd -d " + path);
    }
    const bool is_named = extension == ".db3" || extension == ".mcap" || extension == ".bag";
    if (is_named && is_bag(path)) files.push_back(path);
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace orchard::io
