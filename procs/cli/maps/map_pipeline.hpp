// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "detector/detector_node.hpp"
#include "io/config/config.hpp"
#include "io/file_chunk_allocator.hpp"
#include "mapper/mapper_node.hpp"
#include "pose/pose_node.hpp"

namespace orchard::cli {

/// The three nodes between a log and its map.
struct MapPipeline {
  /// Pose and mapper store the data of a long drive in files in `folder`.
  MapPipeline(const io::Config& config, const std::string& folder)
      : detector(config),
        pose(std::make_unique<procs::PoseNode>(
            config, std::make_shared<io::FileChunkAllocator>(
                        folder, io::FileChunkAllocator::kPoseLoadedMax))),
        mapper(config, std::make_shared<io::FileChunkAllocator>(folder)) {}
  std::vector<bus::Node*> nodes() { return {&detector, pose.get(), &mapper}; }

  procs::DetectorNode detector;
  /// Whoever has no question left to it lets it go: the map takes room while it is written.
  std::unique_ptr<procs::PoseNode> pose;
  procs::MapperNode mapper;
};

}  // namespace orchard::cli
