// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/album_files.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string_view>

#include "io/atomic_file.hpp"
#include "io/file_error.hpp"
#include "io/folder.hpp"

namespace orchard::io {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFolder = "album";
constexpr const char* kTable = "album.csv";

std::string file_name(std::int32_t landmark_id) { return std::to_string(landmark_id) + ".jpg"; }

/// Includes temporary files of a killed process.
bool is_album_file(const std::string& name) {
  static const std::regex kNames(
      "[0-9]+\\.jpg|album\\.csv|\\.([0-9]+|album)\\.[0-9]+-[0-9]+\\.(jpg|csv)");
  return std::regex_match(name, kNames);
}

bool holds(const fs::path& path, std::string_view content) {
  std::error_code error;
  if (fs::file_size(path, error) != content.size() || error) return false;
  std::ifstream file(path, std::ios::binary);
  const std::string there((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  return file && there == content;
}

std::string table_of(const std::vector<mapping::AlbumEntry>& entries) {
  std::string table = "id,image_utime_us,x_px,y_px,width_px,height_px\n";
  for (const mapping::AlbumEntry& entry : entries) {
    const mapping::Photograph& photograph = *entry.photograph;
    table += std::to_string(entry.landmark_id) + "," + std::to_string(photograph.image_utime) +
             "," + std::to_string(photograph.frame.x_px) + "," +
             std::to_string(photograph.frame.y_px) + "," +
             std::to_string(photograph.frame.width_px) + "," +
             std::to_string(photograph.frame.height_px) + "\n";
  }
  return table;
}

}  // namespace

std::string photo_path(std::int32_t landmark_id) {
  return std::string(kFolder) + "/" + file_name(landmark_id);
}

void write_album(const std::string& map_folder, const std::vector<mapping::AlbumEntry>& entries) {
  const fs::path folder = fs::path(map_folder) / kFolder;
  std::set<std::string> names;
  if (!entries.empty()) {
    make_folder(folder.string());
    FileReplacement files;
    const auto write = [&](const std::string& name, std::string_view content) {
      names.insert(name);
      if (!holds(folder / name, content)) files.write((folder / name).string(), content);
    };
    for (const mapping::AlbumEntry& entry : entries) {
      const std::vector<std::uint8_t>& jpeg = entry.photograph->jpeg;
      write(file_name(entry.landmark_id),
            {reinterpret_cast<const char*>(jpeg.data()), jpeg.size()});
    }
    write(kTable, table_of(entries));
    files.commit();
  }
  remove_other_files(folder.string(), names, is_album_file);
}

}  // namespace orchard::io
