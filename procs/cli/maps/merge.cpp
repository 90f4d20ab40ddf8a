// SPDX-License-Identifier: BSD-3-Clause
#include "cli/maps/maps.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <utility>

#include "bus/process/process.hpp"
#include "cli/maps/stored_maps.hpp"
#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"
#include "io/atomic_file.hpp"
#include "io/config/config.hpp"
#include "io/file_error.hpp"
#include "io/map/map_folder.hpp"
#include "io/progress_bar.hpp"
#include "mapping/compare/landmark_pairing.hpp"
#include "mapping/compare/map_merging.hpp"
#include "mapping/finish/finish.hpp"
#include "mapping/rows/row_numbers.hpp"

namespace orchard::cli {
namespace {

std::vector<pose::PoseEstimate> transformed(const std::vector<pose::PoseEstimate>& trajectory,
                                            const geometry::Pose2& T_a_b) {
  std::vector<pose::PoseEstimate> result = trajectory;
  for (pose::PoseEstimate& pose : result) {
    const Eigen::Vector2d p = transform(T_a_b, {pose.x_m, pose.y_m});
    pose.x_m = p.x();
    pose.y_m = p.y();
    pose.yaw_rad = geometry::wrap_angle_rad(pose.yaw_rad + T_a_b.yaw_rad);
  }
  return result;
}

/// A map that was left out, and the reason.
struct LeftOut {
  std::size_t map;
  std::string reason;
};

/// The maps merged so far.
struct Whole {
  io::StoredMap map;  ///< its landmarks are those of `merged`
  mapping::MergedMap merged;
  std::vector<std::vector<mapping::MergedId>> ids_of_map;  ///< empty for a map that is not merged
  std::vector<std::string> laid;  ///< a sentence for each map after the first
  std::vector<LeftOut> left_out;
};

Whole begin_with(const std::vector<io::StoredMap>& maps, std::size_t first,
                 const MergeOptions& options) {
  Whole whole{maps[first], {maps[first].landmarks, maps[first].next_id}, {}, {}, {}};
  whole.map.name = options.map_paths[first];
  whole.ids_of_map.resize(maps.size());
  for (const mapping::Landmark& l : whole.map.landmarks) {
    whole.ids_of_map[first].push_back({l.id, l.id});
  }
  return whole;
}

void add_map(const io::StoredMap& map, std::size_t k, const mapping::MapAlignment& alignment,
             const MergeOptions& options, Whole& whole) {
  std::optional<double> raise_m;
  if (map.georeference && whole.map.georeference) {
    raise_m = map.georeference->altitude_m - whole.map.georeference->altitude_m;
  }
  const auto landmarks = mapping::raised(map.landmarks, raise_m);
  whole.ids_of_map[k] = mapping::merge_into(whole.merged, landmarks, alignment);
  whole.laid.push_back(fmt::format(
      "{}: aligned on {} trunks with a residual of {:.0f} mm (RMS; {:.0f} mm by the errors that "
      "the maps tell); moved by {:.3f} m, {:.3f} m and {:.3f} degrees",
      options.map_paths[k], alignment.pairs.size(), 1e3 * alignment.rms_m,
      1e3 * mapping::told_rms_m(whole.map.landmarks, map.landmarks, alignment.pairs),
      alignment.T_a_b.x_m, alignment.T_a_b.y_m, alignment.T_a_b.yaw_rad * 180.0 / geometry::kPi));
  whole.map.landmarks = whole.merged.landmarks;
  for (const auto& trajectory : map.trajectories) {
    whole.map.trajectories.push_back(transformed(trajectory, alignment.T_a_b));
  }
}

/// Merges the other maps into the one at `first`; a map that overlaps only a later one is added
/// after that one. Throws io::FileError when a map cannot be registered, unless such maps are left
/// out.
Whole lay_all(const std::vector<io::StoredMap>& maps, std::size_t first,
              const MergeOptions& options, io::ProgressBar& bar) {
  Whole whole = begin_with(maps, first, options);
  std::vector<std::size_t> left;
  for (std::size_t k = 0; k < maps.size(); ++k) {
    if (k != first) left.push_back(k);
  }
  while (!left.empty()) {
    bar.update(maps.size() - 1 - left.size(), maps.size() - 1);
    const mapping::DetectionMap view = view_of(whole.map, options.reach_m);
    std::vector<LeftOut> refused;
    std::optional<std::size_t> next;
    for (std::size_t i = 0; i < left.size() && !next; ++i) {
      const std::size_t k = left[i];
      try {
        const auto alignment = register_map(whole.map, view, maps[k],
                                            view_of(maps[k], options.reach_m), options.alignment);
        add_map(maps[k], k, alignment, options, whole);
        next = i;
      } catch (const io::FileError& error) {
        refused.push_back({k, error.what()});
      }
    }
    if (!next) {
      if (!options.leave_out) throw io::FileError(refused.front().reason);
      whole.left_out = std::move(refused);
      break;
    }
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(*next));
  }
  bar.finish();
  return whole;
}

/// What the earlier maps tell of the new ones.
struct Earlier {
  std::optional<io::CorrectedMapFolder> map;  ///< the newest that a new map fits
  std::string path;                           ///< of that map
  std::size_t first = 0;                      ///< the new map that fits it
  std::int32_t next_id = 0;                   ///< above every id of all that were read
  std::vector<std::pair<std::string, std::string>> refused;  ///< paths of the others, reasons
};

/// Looks for the newest earlier map that one of the maps fits; unless maps may be left out, it must
/// be the newest of all.
Earlier find_earlier(const std::vector<io::StoredMap>& maps, const MergeOptions& options) {
  Earlier earlier;
  for (const std::string& path : options.previous_paths) {
    io::CorrectedMapFolder previous = io::read_corrected_map(path);
    require_other_folder(options.out_folder, {path});
    require_corrections_of(options.out_folder, previous);
    earlier.next_id =
        std::max({earlier.next_id, previous.mapped.next_id, previous.corrected.next_id});
    const mapping::DetectionMap view = view_of(previous.mapped, 0.0);
    std::vector<std::string> reasons;
    for (std::size_t k = 0; k < maps.size() && !earlier.map; ++k) {
      try {
        if (options.leave_out) {
          register_map(previous.mapped, view, maps[k], view_of(maps[k], options.reach_m),
                       options.alignment);
        }
        earlier.first = k, earlier.path = path;
        earlier.map = std::move(previous);
      } catch (const io::FileError& error) {
        reasons.push_back(error.what());
      }
    }
    if (earlier.map) break;
    for (std::string& reason : reasons) earlier.refused.emplace_back(path, std::move(reason));
  }
  return earlier;
}

/// The merge that leaves out the fewest maps. Throws io::FileError with all reasons if it leaves
/// out at least half of them.
Whole largest_whole(const std::vector<io::StoredMap>& maps, const MergeOptions& options,
                    io::ProgressBar& bar) {
  std::optional<Whole> best;
  std::vector<bool> is_in(maps.size(), false);  // same merge again
  for (std::size_t first = 0; first < maps.size(); ++first) {
    if (is_in[first]) continue;
    Whole whole = lay_all(maps, first, options, bar);
    for (std::size_t k = 0; k < maps.size(); ++k) {
      if (!whole.ids_of_map[k].empty()) is_in[k] = true;
    }
    if (!best || whole.left_out.size() < best->left_out.size()) best = std::move(whole);
  }
  if (2 * best->left_out.size() >= maps.size()) {
    std::string reasons;
    for (const LeftOut& out : best->left_out) reasons += out.reason + "; ";
    throw io::FileError(
        reasons +
        "most maps do not fit each other, so it is unknown which ones are of this orchard");
  }
  return std::move(*best);
}

Whole lay(const std::vector<io::StoredMap>& maps, const Earlier& earlier,
          const MergeOptions& options) {
  io::ProgressBar bar("merging");
  if (options.leave_out && !earlier.map) return largest_whole(maps, options, bar);
  return lay_all(maps, options.leave_out ? earlier.first : 0, options, bar);
}

/// Takes ids, numbers and corrections from the earlier map, if there is one that the merged map
/// fits.
EarlierIdentity join(Earlier& earlier, const MergeOptions& options, io::MapFolderContent& content) {
  if (earlier.map) {
    try {
      return transfer_identity(*earlier.map, options.alignment, content);
    } catch (const io::FileError& error) {
      if (!options.leave_out) throw;
      earlier.refused.emplace_back(earlier.path, error.what());
      earlier.map.reset();
    }
  }
  for (mapping::Landmark& l : content.landmarks) l.id += earlier.next_id;
  content.next_id += earlier.next_id;
  return {};
}

/// ids.csv with the current ids; `before`: the landmarks with the ids at the time of merging.
std::string ids_csv(const std::vector<std::vector<mapping::MergedId>>& ids_of_map,
                    const std::vector<mapping::Landmark>& before,
                    const std::vector<mapping::Landmark>& now) {
  using Place = std::pair<double, double>;
  std::map<Place, std::int32_t> id_at;  // positions are unchanged and identify landmarks
  for (const mapping::Landmark& l : now) id_at[{l.x_m, l.y_m}] = l.id;
  std::map<std::int32_t, std::int32_t> renaming;
  for (const mapping::Landmark& l : before) renaming[l.id] = id_at.at({l.x_m, l.y_m});
  std::string text = "map,id,merged_id\n";
  for (std::size_t k = 0; k < ids_of_map.size(); ++k) {
    for (const mapping::MergedId& id : ids_of_map[k]) {
      text += fmt::format("{},{},{}\n", k + 1, id.before, renaming.at(id.now));
    }
  }
  return text;
}

/// A CSV field, quoted where it must be.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + "\"";
}

}  // namespace

int run_merge(const MergeOptions& options) {
  const mapping::RowsConfig rows = options.config_path.empty()
                                       ? mapping::RowsConfig{}
                                       : io::load_config(options.config_path).mapper.rows;
  std::vector<io::StoredMap> maps;
  for (const std::string& path : options.map_paths) maps.push_back(io::read_stored_map(path));
  require_other_folder(options.out_folder, options.map_paths);
  Earlier earlier = find_earlier(maps, options);
  Whole laid = lay(maps, earlier, options);
  const mapping::MergedMap& merged = laid.merged;
  for (const std::string& sentence : laid.laid) std::printf("%s\n", sentence.c_str());
  mapping::FreeSpaceTest seen_free = seen_free_of(laid.map);
  io::MapFolderContent content = content_of(std::move(laid.map));
  content.landmarks = merged.landmarks;
  content.next_id = merged.next_id;
  content.summary.source = "merged";
  for (std::size_t k = 0; k < maps.size(); ++k) {
    content.summary.counts.push_back({"map_" + std::to_string(k + 1) + "_landmarks",
                                      static_cast<std::int64_t>(maps[k].landmarks.size())});
    maps[k] = {};  // large
  }
  std::string left_out_csv = "map,reason\n";
  for (const LeftOut& out : laid.left_out) {
    content.summary.warnings.push_back("left out: " + out.reason);
    std::fprintf(stderr, "orchard merge: warning: left out: %s\n", out.reason.c_str());
    left_out_csv += quoted(options.map_paths[out.map]) + "," + quoted(out.reason) + "\n";
  }
  for (const std::string& path : options.map_paths) {
    if (!std::filesystem::is_directory(path) || io::read_corrections(path).list.empty()) continue;
    content.summary.warnings.push_back("corrections of " + path +
                                       " are not merged; to include them, write a corrected map "
                                       "with `orchard edit apply MAP` and merge that");
    std::fprintf(stderr, "orchard merge: warning: %s\n", content.summary.warnings.back().c_str());
  }
  mapping::number_merged(rows, content.landmarks);
  const EarlierIdentity kept = join(earlier, options, content);
  for (const auto& [path, reason] : earlier.refused) {
    left_out_csv += quoted(path) + "," + quoted(reason) + "\n";
  }
  if (!options.previous_paths.empty() && !earlier.map) {
    content.summary.warnings.push_back("no map fits one of an earlier date, so all ids are new");
    std::fprintf(stderr, "orchard merge: warning: %s\n", content.summary.warnings.back().c_str());
  }
  if (earlier.map) {
    std::printf("ids of %s: %d kept, %d gone, %d new\n", earlier.path.c_str(),
                kept.numbers.num_found, kept.numbers.num_gone, kept.numbers.num_new);
    const std::string told = account_corrections("orchard merge", kept.corrections, content);
    if (!told.empty()) std::printf("corrections by hand: %s\n", told.c_str());
  }
  content.rows = mapping::numbered_rows(content.landmarks);
  content.graph = mapping::navigation_graph(content.landmarks, content.rows, seen_free);
  seen_free = {};
  content.ids_csv = ids_csv(laid.ids_of_map, merged.landmarks, content.landmarks);
  io::write_map_folder(options.out_folder, content);
  write_corrections(options.out_folder, kept.corrections);
  if (options.leave_out) {
    io::write_file_atomically(options.out_folder + "/left_out.csv", left_out_csv);
  }
  std::printf(
      "%zu landmarks from %zu maps, written to %s; ids.csv lists the ids before and after\n",
      content.landmarks.size(), maps.size() - laid.left_out.size(), options.out_folder.c_str());
  return bus::kExitOk;
}

}  // namespace orchard::cli
