// SPDX-License-Identifier: BSD-3-Clause
#include "cli/maps/maps.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "bus/process/process.hpp"
#include "cli/maps/stored_maps.hpp"
#include "cli/paths.hpp"
#include "io/atomic_file.hpp"
#include "io/file_error.hpp"
#include "io/gis/geo_file.hpp"
#include "io/gis/task_file.hpp"
#include "mapping/inventory/tasks.hpp"

namespace orchard::cli {
namespace {

std::string day_of(const std::string& map_path) {
  const std::string day = facts_of(map_path).day;
  return day.empty() ? "an unknown day" : day;
}

io::GeoFormat format_of(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".geojson") return io::GeoFormat::kGeoJson;
  if (extension == ".gpkg") return io::GeoFormat::kGeoPackage;
  if (extension == ".gpx") return io::GeoFormat::kGpx;
  throw io::FileError(path +
                      ": tasks are written as .geojson or .gpkg, to be ticked, or as .gpx, for a "
                      "receiver; change --out");
}

mapping::TaskUpdate updated(const TasksOptions& options, const MapInput& map) {
  std::vector<mapping::Task> earlier;
  if (!options.ticked_path.empty()) {
    earlier = io::read_tasks(options.ticked_path, map.map.georeference);
  }
  const std::vector<mapping::Row> rows = mapping::numbered_rows(map.map.landmarks);
  const mapping::TaskMap now{map.map.landmarks, rows, map.row_names, day_of(options.map_path)};
  if (options.previous_path.empty()) return update_tasks(std::move(earlier), now, nullptr);
  const ComparedMaps compared =
      compare_with_earlier("orchard tasks", options.previous_path, options.map_path, map,
                           options.as_mapped, options.alignment);
  const mapping::EarlierTrees before{compared.before.map.landmarks, compared.comparison,
                                     compared.alignment, day_of(options.previous_path)};
  return update_tasks(std::move(earlier), now, &before);
}

}  // namespace

int run_tasks(const TasksOptions& options) {
  const io::GeoFormat format = format_of(options.out_path);
  require_free(options.out_path, options.overwrite);
  const MapInput map = read_map_input("orchard tasks", options.map_path, options.as_mapped);
  const mapping::TaskUpdate update = updated(options, map);
  const auto num_done = std::count_if(update.tasks.begin(), update.tasks.end(),
                                      [](const auto& task) { return task.is_done; });
  const auto num_earlier = static_cast<int>(update.tasks.size()) - update.num_new;
  const std::unique_ptr<io::LayerFile> file = io::geo_file(map.map.georeference, format);
  io::write_tasks(update.tasks, *file);
  make_parent_folder(options.out_path);
  io::FileReplacement files;
  files.write(options.out_path, file->finish());
  files.commit();
  if (num_earlier > 0 && update.num_found + update.num_seen == 0) {
    std::fprintf(stderr,
                 "orchard tasks: warning: none of the %d tasks of %s is at a gap or new tree of "
                 "this map; is it of another block, or in another place (map --previous)?\n",
                 num_earlier, options.ticked_path.c_str());
  }
  if (options.json) {
    const nlohmann::ordered_json json{{"file", options.out_path},
                                      {"open", static_cast<long>(update.tasks.size()) - num_done},
                                      {"done", num_done},
                                      {"new", update.num_new},
                                      {"seen", update.num_seen}};
    std::printf("%s\n", json.dump(2).c_str());
    return bus::kExitOk;
  }
  std::printf("%s: %ld open, %ld done; %d new, %d done as a tree stands there now\n",
              options.out_path.c_str(), static_cast<long>(update.tasks.size()) - num_done,
              static_cast<long>(num_done), update.num_new, update.num_seen);
  return bus::kExitOk;
}

}  // namespace orchard::cli
