// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/map_tile_files.hpp"

#include <filesystem>
#include <regex>
#include <set>

#include "io/atomic_file.hpp"
#include "io/folder.hpp"

namespace orchard::io {
namespace {

/// Includes temporary files of a killed process.
bool is_tile_file(const std::string& name) {
  static const std::regex kNames(
      "(-?[0-9]+_-?[0-9]+|index)\\.js|\\.(-?[0-9]+_-?[0-9]+|index)\\.[0-9]+-[0-9]+\\.js");
  return std::regex_match(name, kNames);
}

}  // namespace

void write_map_tiles(const std::string& map_folder, const view::MapTiles* tiles) {
  const std::filesystem::path folder = std::filesystem::path(map_folder) / "map_tiles";
  std::set<std::string> names;
  if (tiles != nullptr) {
    make_folder(folder.string());
    FileReplacement files;
    const auto write = [&](const std::string& name, const std::string& json) {
      names.insert(name + ".js");
      files.write((folder / (name + ".js")).string(),
                  "orchardTile(\"" + name + "\"," + json + ");\n");
    };
    for (const std::string& name : tiles->names()) write(name, *tiles->tile_json(name));
    write("index", tiles->index_json());
    files.commit();
  }
  remove_other_files(folder.string(), names, is_tile_file);
}

}  // namespace orchard::io
