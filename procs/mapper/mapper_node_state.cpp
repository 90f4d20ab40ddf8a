// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <memory>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "mapper/mapper_node.hpp"

namespace orchard::procs {
namespace {

using mapping::StateArchive;

void persist(StateArchive& archive, pose::Trajectory& trajectory) { archive(trajectory); }

void persist(StateArchive& archive, detection::Detections& detections) {
  archive(detections.utime, detections.seq, detections.image_utime, detections.trunks);
}

void persist(StateArchive& archive, std::shared_ptr<mapping::FreeSpace>& free_space) {
  std::vector<std::uint8_t> bytes;
  if (!archive.is_reading()) bytes = free_space->pack();
  archive(bytes);
  if (archive.is_reading()) {
    free_space = std::make_shared<mapping::FreeSpace>(mapping::FreeSpace::unpack(bytes));
  }
}

template <class Item, class Waiting>
void persist_as(StateArchive& archive, Waiting& waiting) {
  if (archive.is_reading()) waiting = Item{};
  persist(archive, std::get<Item>(waiting));
}

}  // namespace

void MapperNode::persist(StateArchive& archive) {
  queue_.persist(archive, [](StateArchive& to, std::size_t kind, Waiting& waiting) {
    switch (kind) {
      case kTrajectory:
        return persist_as<pose::Trajectory>(to, waiting);
      case kDetections:
        return persist_as<detection::Detections>(to, waiting);
      default:
        return persist_as<FreeSpacePtr>(to, waiting);
    }
  });
  std::optional<std::array<double, 3>> datum = gnss_.datum();
  archive(datum);
  if (datum) gnss_.set_datum(*datum);
  archive(fixes_, mapper_, track_, collector_, degradation_, beam_times_, last_kept_scan_utime_,
          has_pose_caught_up_, is_scan_missing_, last_id_, is_flushed_, moved_m_, num_rebuilt_,
          last_used_utime_, next_seq_, next_ways_seq_, refresh_from_id_, last_refresh_utime_,
          counts_, album_);
}

}  // namespace orchard::procs
