// SPDX-License-Identifier: BSD-3-Clause
#include "cli/maps/maps.hpp"

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "bus/process/process.hpp"
#include "cli/maps/stored_maps.hpp"
#include "cli/paths.hpp"
#include "io/atomic_file.hpp"
#include "io/file_error.hpp"
#include "io/gis/geo_file.hpp"
#include "io/gis/map_layers.hpp"
#include "io/gis/robot_files.hpp"
#include "io/map/corrected_map.hpp"

namespace orchard::cli {
namespace {

bool ends_with(const std::string& name, const std::string& end) {
  return name.size() > end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
}

/// The format of that word whose extension the file has.
const io::GeoFormatInfo& format_of(const ExportOptions& options) {
  const std::string name = std::filesystem::path(options.out_path).filename().string();
  std::string names;
  for (const io::GeoFormatInfo& format : io::geo_formats()) {
    if (options.format != format.word) continue;
    if (ends_with(name, format.extension)) return format;
    names += (names.empty() ? "NAME" : " or NAME") + std::string(format.extension);
  }
  throw io::FileError(options.out_path + ": the name of a file in format " + options.format +
                      " must be " + names + "; change --out");
}

/// Writes the file, and with its name those that belong beside it.
void write(const ExportOptions& options, io::LayerFile& file) {
  io::FileReplacement files;
  files.write(options.out_path, file.finish());
  for (const auto& [extension, bytes] : file.companions()) {
    std::filesystem::path path(options.out_path);
    path.replace_extension(extension);
    require_free(path.string(), options.overwrite);
    files.write(path.string(), bytes);
  }
  files.commit();
}

void print_words(const ExportOptions& options, const io::GeoFormatInfo& format,
                 const io::LayerFile& file, const io::CorrectedMapFolder& map) {
  std::string layers, left_out;
  for (const auto& [name, num] : file.written()) {
    layers += (layers.empty() ? "" : ", ") + std::to_string(num) + " in " + name;
  }
  for (const std::string& name : file.left_out()) left_out += (left_out.empty() ? "" : ", ") + name;
  std::printf("%s: %s\n", options.out_path.c_str(), layers.c_str());
  std::printf("coordinates: %s\n", io::geo_system_text(map.mapped.georeference, format).c_str());
  if (!map.corrections.empty()) {
    std::printf("corrections: %s\n", io::corrections_text(map.corrected).c_str());
  }
  if (!left_out.empty()) {
    std::printf(
        "left out: %s%s\n", left_out.c_str(),
        format.has_one_layer ? " (this format stores one layer; choose it with --layer)" : "");
  }
  if (*format.lost != '\0') std::printf("%s\n", format.lost);
}

void print_json(const ExportOptions& options, const io::GeoFormatInfo& format,
                const io::LayerFile& file, const io::CorrectedMapFolder& map) {
  nlohmann::ordered_json json{
      {"file", options.out_path},
      {"format", format.word},
      {"coordinates", io::geo_system_text(map.mapped.georeference, format)},
      {"georeferenced", map.mapped.georeference.has_value()},
      {"corrections", map.corrections.size()},
      {"conflicts", map.corrected.count(mapping::CorrectionOutcome::kConflict)},
      {"layers", nlohmann::ordered_json::object()},
      {"left_out", file.left_out()},
      {"lost", format.lost}};
  for (const auto& [name, num] : file.written()) json["layers"][name] = num;
  std::printf("%s\n", json.dump(2).c_str());
}

/// Writes the map for robots: one file, or a YAML with its image, or a path for each drive.
int export_for_robots(const ExportOptions& options, const io::GeoFormatInfo& format,
                      const io::CorrectedMapFolder& map) {
  const std::filesystem::path out(options.out_path);
  std::vector<std::pair<std::filesystem::path, std::string>> written;
  const bool is_route_graph = format.format == io::GeoFormat::kRouteGraph;
  if (is_route_graph || format.format == io::GeoFormat::kTopologicalMap) {
    if (map.graph.edges.empty()) {
      throw io::FileError(map.mapped.name + " has no graph.json beside it, or one without aisles");
    }
    const auto& paths = map.mapped.trajectories;
    const std::int64_t utime =
        paths.empty() || paths.back().empty() ? 0 : paths.back().back().utime;
    written.emplace_back(out, is_route_graph
                                  ? io::route_graph(map.graph, map.corrected.row_names)
                                  : io::topological_map(map.graph, map.corrected.row_names,
                                                        out.stem().string(), utime));
  } else if (format.format == io::GeoFormat::kOccupancyGrid) {
    const std::filesystem::path image = std::filesystem::path(out).replace_extension(".pgm");
    auto grid = io::occupancy_grid(map.corrected.landmarks, map.graph, map.mapped.trajectories,
                                   image.filename().string());
    written.emplace_back(out, std::move(grid.yaml));
    written.emplace_back(image, std::move(grid.pgm));
  }
  for (std::size_t i = 0;
       format.format == io::GeoFormat::kKitti && i < map.mapped.trajectories.size(); ++i) {
    const std::string number = i > 0 ? "_" + std::to_string(i + 1) : "";
    written.emplace_back(out.parent_path() / (out.stem().string() + number + ".txt"),
                         io::kitti_poses(map.mapped.trajectories[i]));
  }
  if (written.empty()) throw io::FileError(map.mapped.name + " has no trajectory.csv beside it");
  make_parent_folder(options.out_path);
  io::FileReplacement files;
  for (const auto& [path, text] : written) {
    require_free(path.string(), options.overwrite);
    files.write(path.string(), text);
    if (!options.json) std::printf("%s\n", path.c_str());
  }
  files.commit();
  const nlohmann::ordered_json json{{"file", options.out_path}, {"format", format.word}};
  if (options.json) std::printf("%s\n", json.dump(2).c_str());
  return bus::kExitOk;
}

}  // namespace

int run_export(const ExportOptions& options) {
  const io::GeoFormatInfo& format = format_of(options);
  if (options.layer == "keep-outs" && options.keep_out_m == 0.0) {
    throw io::FileError("--layer keep-outs needs a margin in metres: add --keep-out 0.5");
  }
  const std::filesystem::path folder = std::filesystem::path(options.out_path).parent_path();
  require_other_folder(folder.empty() ? "." : folder.string(), {options.map_path});
  require_free(options.out_path, options.overwrite);
  const io::CorrectedMapFolder map = io::read_corrected_map(options.map_path, options.as_mapped);
  if (*format.driver == '\0') return export_for_robots(options, format, map);
  io::MapLayers layers;
  layers.landmarks = &map.corrected.landmarks;
  for (const auto& trajectory : map.mapped.trajectories) layers.trajectories.push_back(&trajectory);
  layers.rows = &map.rows;
  layers.graph = &map.graph;
  layers.georeference = &map.mapped.georeference;
  layers.row_names = map.corrected.row_names;
  layers.notes = map.corrected.notes;
  layers.keep_out_m = options.keep_out_m;
  layers.num_corrections = static_cast<int>(map.corrections.size());
  const std::unique_ptr<io::LayerFile> file = io::geo_file(map.mapped.georeference, format.format);
  if (!options.layer.empty()) file->choose_layer(options.layer);
  io::write_map_layers(layers, *file);
  make_parent_folder(options.out_path);
  write(options, *file);
  warn_of_conflicts("orchard export", options.map_path, map.corrected);
  (options.json ? print_json : print_words)(options, format, *file, map);
  return bus::kExitOk;
}

}  // namespace orchard::cli
