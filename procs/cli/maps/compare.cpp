// SPDX-License-Identifier: BSD-3-Clause
#include "cli/maps/maps.hpp"

#include <fmt/core.h>
#include <cmath>
#include <cstdio>

#include "bus/process/process.hpp"
#include "cli/maps/stored_maps.hpp"
#include "geometry/angles.hpp"
#include "io/file_error.hpp"
#include "io/map/comparison_files.hpp"

namespace orchard::cli {
namespace {

using mapping::Change;
using mapping::MapChange;

constexpr int kLinesMax = 60;

void require_views(const CompareOptions& options, const io::StoredMap& map,
                   const std::string& path) {
  if (options.comparison.assume_seen || !map.trajectories.empty()) return;
  throw io::FileError(path +
                      " has no trajectory.csv beside it, so trees that were not observed cannot be "
                      "distinguished from missing ones; give the map's folder, or --assume-seen");
}

void print_change(const io::ComparisonContent& content, const MapChange& c) {
  const mapping::Landmark& l = c.a >= 0 ? content.a[static_cast<std::size_t>(c.a)]
                                        : content.b[static_cast<std::size_t>(c.b)];
  const std::string id_a = c.a >= 0 ? std::to_string(l.id) : "-";
  const std::string id_b =
      c.b >= 0 ? std::to_string(content.b[static_cast<std::size_t>(c.b)].id) : "-";
  const std::string place =
      l.row != 0 ? std::to_string(l.row) + "/" + std::to_string(l.position) : "-";
  std::string detail;
  if (c.change == Change::kMoved) detail = fmt::format("by {:.2f} m", c.moved_m);
  if (c.change == Change::kGrown || c.change == Change::kThinner) {
    detail = fmt::format("by {:+.1f} mm (standard error {:.1f})", 1e3 * c.width_change_m,
                         1e3 * c.width_change_se_m);
  }
  std::printf("%-9s  %10.3f  %6s  %6s  %8s  %9.2f  %9.2f  %s\n", mapping::change_text(c.change),
              c.confidence, id_a.c_str(), id_b.c_str(), place.c_str(), c.p_a.x(), c.p_a.y(),
              detail.c_str());
}

void print_table(const io::ComparisonContent& content) {
  const mapping::MapAlignment& alignment = content.alignment;
  std::printf(
      "aligned on %zu pairs of trunks with a residual of %.0f mm (RMS; %.0f mm by the errors that "
      "the maps tell); the origin of the later map is at\n"
      "  x %+.3f m, y %+.3f m, rotated by %+.3f degrees (standard deviations %.0f mm, %.0f mm, "
      "%.3f degrees)\n",
      alignment.pairs.size(), 1e3 * alignment.rms_m,
      1e3 * mapping::told_rms_m(content.a, content.b, alignment.pairs), alignment.T_a_b.x_m,
      alignment.T_a_b.y_m, alignment.T_a_b.yaw_rad * 180.0 / geometry::kPi,
      1e3 * std::sqrt(alignment.covariance(0, 0)), 1e3 * std::sqrt(alignment.covariance(1, 1)),
      std::sqrt(alignment.covariance(2, 2)) * 180.0 / geometry::kPi);
  for (const Change change : {Change::kMissing, Change::kNew, Change::kMoved, Change::kGrown,
                              Change::kThinner, Change::kUnchanged, Change::kNotSeen}) {
    std::printf("%-9s %6d\n", mapping::change_text(change), content.comparison.count(change));
  }
  std::printf("mean change of width: %+.1f mm (standard error %.1f)\n",
              1e3 * content.comparison.width_change_common_m,
              1e3 * content.comparison.width_change_common_se_m);
  int num_lines = 0;
  for (const Change change :
       {Change::kMissing, Change::kNew, Change::kMoved, Change::kGrown, Change::kThinner}) {
    for (const MapChange& c : content.comparison.changes) {
      if (c.change != change || num_lines >= kLinesMax) continue;
      if (num_lines++ == 0) {
        std::printf("\nchange     confidence    id_a    id_b  row/tree          x          y\n");
      }
      print_change(content, c);
    }
  }
  if (num_lines >= kLinesMax) std::printf("... more in compare.csv (--out DIR)\n");
}

}  // namespace

int run_compare(const CompareOptions& options) {
  MapInput input_a = read_map_input("orchard compare", options.earlier_path, options.as_mapped);
  MapInput input_b = read_map_input("orchard compare", options.later_path, options.as_mapped);
  const io::StoredMap &a = input_a.map, &b = input_b.map;
  require_views(options, input_a.mapped, options.earlier_path);
  require_views(options, input_b.mapped, options.later_path);
  mapping::DetectionMap view_a = view_of(input_a.mapped, options.reach_m);
  mapping::DetectionMap view_b = view_of(input_b.mapped, options.reach_m);
  for (MapInput* input : {&input_a, &input_b}) input->mapped.trajectories = {};  // large
  const mapping::MapAlignment alignment =
      register_map(input_a, view_a, input_b, view_b, options.alignment);
  const mapping::MapComparison comparison = mapping::compare_maps(
      a.landmarks, b.landmarks, view_a, view_b, alignment, options.comparison);
  for (MapInput* input : {&input_a, &input_b}) input->mapped = {};  // room for the figures
  view_a = view_b = {};
  const io::ComparisonContent content{options.earlier_path, options.later_path, a.landmarks,
                                      b.landmarks,          alignment,          comparison,
                                      a.georeference};
  if (!options.out_folder.empty()) io::write_comparison_folder(options.out_folder, content);
  if (options.json) {
    std::fputs(io::comparison_json(content).c_str(), stdout);
  } else {
    print_table(content);
    if (!options.out_folder.empty()) {
      std::printf(
          "\nwritten to %s: compare.csv, compare.gpkg (QGIS), compare.svg, compare.png, "
          "compare.json\n",
          options.out_folder.c_str());
    }
  }
  return bus::kExitOk;
}

}  // namespace orchard::cli
