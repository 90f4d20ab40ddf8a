// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <string>

#include "bus/process.hpp"
#include "io/map_folder.hpp"
#include "mapper/mapper_node.hpp"

int main(int argc, char** argv) {
  std::string folder;
  std::int64_t config_hash = 0;
  orchard::bus::ProcessInfo info;
  info.name = "orchard-mapper";
  info.description =
      "Accumulates detections into the map of the orchard.\n"
      "Reads DETECTIONS and POSE, sends MAP, and saves the map's files while it runs.";
  info.options.push_back({"--out", "DIR", "folder of the map's files (none are saved without)",
                          &folder});
  return orchard::bus::run_node_process(
      argc, argv, info,
      [&](const orchard::io::Config& config) -> std::unique_ptr<orchard::bus::Node> {
        config_hash = orchard::io::config_hash(config);
        return std::make_unique<orchard::procs::MapperNode>(config);
      },
      [&](orchard::bus::Node& node, bool) {
        if (folder.empty()) return;
        const auto& mapper = dynamic_cast<const orchard::procs::MapperNode&>(node);
        orchard::io::MapSummary summary;
        summary.source = "live";
        summary.config_hash = config_hash;
        orchard::io::MapFolderContent content = mapper.content(summary);
        if (!content.trajectory.empty()) {
          content.summary.first_utime = content.trajectory.front().utime;
          content.summary.last_utime = content.trajectory.back().utime;
        }
        orchard::io::write_map_folder(folder, content);
      });
}
