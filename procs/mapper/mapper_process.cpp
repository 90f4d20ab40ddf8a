// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/mapper_process.hpp"

#include <spdlog/spdlog.h>

#include <stdexcept>

#include "io/file_error.hpp"
#include "mapper/journaled_mapper.hpp"

namespace orchard::procs {

std::unique_ptr<bus::Node> MapperProcess::make_node(const io::Config& config,
                                                    std::int64_t config_hash,
                                                    const std::string& folder, bool lockstep) {
  saver_.emplace(folder, config_hash);
  if (folder.empty()) return std::make_unique<MapperNode>(config);
  try {
    if (!place_) place_.emplace(folder);
    if (place_->num_removed_temporaries() > 0) {
      spdlog::info("{}: {} unfinished files of killed processes removed", folder,
                   place_->num_removed_temporaries());
    }
    if (lockstep) return std::make_unique<MapperNode>(config);
    auto mapper = std::make_unique<JournaledMapper>(config, config_hash, *place_);
    mapper->before_new_map([this](const MapperNode& earlier) {
      saver_->save(earlier, {bus::SaveKind::kFinal, {}});
      saver_->begin_new_map();
    });
    return mapper;
  } catch (const io::FileError& error) {  // a failure to write, not a bad input file
    throw std::runtime_error(error.what());
  }
}

void MapperProcess::save(bus::Node& node, const bus::SaveRequest& request) {
  auto* journaled = dynamic_cast<JournaledMapper*>(&node);
  if (journaled == nullptr) return saver_->save(dynamic_cast<const MapperNode&>(node), request);
  bus::SaveRequest all = request;
  for (std::size_t i = 0; i < bus::kNumChannels; ++i) {
    all.traffic.num_in[i] += journaled->num_replayed()[i];
  }
  saver_->set_notes(journaled->notes());
  // Write the journal first, so that a restart can restore the map; save the map even if this
  // fails.
  std::string not_kept;
  try {
    journaled->commit();
  } catch (const io::FileError& error) {
    not_kept = error.what();
  }
  saver_->save(journaled->mapper(), all);
  if (!not_kept.empty()) throw io::FileError(not_kept);
}

}  // namespace orchard::procs
