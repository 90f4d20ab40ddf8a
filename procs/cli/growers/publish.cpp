// SPDX-License-Identifier: BSD-3-Clause
#include "cli/maps/maps.hpp"

#include <cinttypes>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "bus/process/process.hpp"
#include "cli/interruptible_work.hpp"
#include "cli/maps/stored_maps.hpp"
#include "io/file_error.hpp"
#include "io/map/corrected_map.hpp"
#include "io/postgis/publication.hpp"
#include "text/date_problem.hpp"
#include "text/number_text.hpp"

namespace orchard::cli {
namespace {

constexpr std::size_t kLongestBlock = 64;

std::string date_for(const PublishOptions& options, const io::StoredMap& map) {
  if (!options.date.empty()) {
    const std::string problem = date_problem(options.date);
    if (!problem.empty()) throw io::FileError("--date " + options.date + " " + problem);
    return options.date;
  }
  const std::string date =
      map.trajectories.empty() ? std::string() : date_text(map.trajectories.front().front().utime);
  if (date.empty()) {
    throw io::FileError(map.name + " has no date of the drive; give it with --date");
  }
  return date;
}

void require_block(const std::string& block) {
  bool is_plain = !block.empty() && block.size() <= kLongestBlock;
  for (const char c : block) is_plain = is_plain && static_cast<unsigned char>(c) >= 0x20;
  if (!is_plain) {
    throw io::FileError("--block: give a name of 1 to " + std::to_string(kLongestBlock) +
                        " characters, without control characters");
  }
}

/// The grower's names of rows: those given by corrections, else those of the plan.
std::vector<io::Publication::Name> names_of(const io::CorrectedMapFolder& map) {
  const mapping::PlanNames& of_plan = map.mapped.plan_names;
  const auto& row_names = map.corrected.row_names;
  std::vector<io::Publication::Name> names;
  if (of_plan.empty() && row_names.empty()) return names;
  for (const mapping::Landmark& l : map.corrected.landmarks) {
    io::Publication::Name& name = names.emplace_back();
    if (const auto at = of_plan.find(l.id); at != of_plan.end()) {
      name = {at->second.row, at->second.tree};
    }
    if (const auto row = row_names.find(l.row); row != row_names.end()) name.row = row->second;
  }
  return names;
}

}  // namespace

int run_publish(const PublishOptions& options) {
  require_block(options.block);
  const io::CorrectedMapFolder corrected =
      io::read_corrected_map(options.map_path, options.as_mapped);
  const io::StoredMap& map = corrected.mapped;
  io::Publication publication;
  publication.block = options.block;
  publication.date = date_for(options, map);
  publication.source = map_name(options.map_path);
  publication.landmarks = corrected.corrected.landmarks;
  publication.names = names_of(corrected);
  publication.georeference = map.georeference;
  InterruptibleWork work("publishing", !options.json);
  const io::PublishedCounts counts =
      io::publish(options.url, publication,
                  [&work](std::uint64_t done, std::uint64_t total) { work.update(done, total); });
  work.finish();
  if (options.json) {
    const nlohmann::ordered_json json{{"block", publication.block},
                                      {"date", publication.date},
                                      {"published", counts.num_published},
                                      {"replaced", counts.num_replaced},
                                      {"georeferenced", publication.georeference.has_value()}};
    std::printf("%s\n", json.dump(2).c_str());
    return bus::kExitOk;
  }
  std::printf("%" PRId64 " trees and objects published as block %s of %s", counts.num_published,
              publication.block.c_str(), publication.date.c_str());
  if (counts.num_replaced > 0) {
    std::printf("; %" PRId64 " rows of an earlier publication were moved to orchard.tree_replaced",
                counts.num_replaced);
  }
  std::printf("\n");
  if (!publication.georeference) {
    std::printf("the map is not georeferenced: column place is empty, x_m and y_m are filled\n");
  }
  return bus::kExitOk;
}

}  // namespace orchard::cli
