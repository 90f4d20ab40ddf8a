// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bus/node/node.hpp"
#include "io/config/config.hpp"
#include "io/file_chunk_allocator.hpp"
#include "io/journal.hpp"
#include "io/map/map_folder_lock.hpp"
#include "io/snapshot.hpp"
#include "mapper/mapper_node.hpp"

namespace orchard::procs {

/// A mapper that can resume its map after a restart. It saves snapshots of its state beside the
/// map, and a journal of its inputs since the last snapshot; the constructor restores both. The map
/// is a function of its inputs, so it continues exactly as without the restart, with the same ids.
///
/// A map without these files, of another configuration or with a damaged file is not continued: it
/// is set aside. So is a map whose frame ended because orchard-pose restarted in a mode with its
/// own origin. STATUS and summary.json report it.
class JournaledMapper : public bus::Node {
 public:
  static constexpr const char* kJournalName = "mapper.journal";
  static constexpr const char* kSnapshotName = "mapper.snapshot";
  /// The chunks of a long drive's data; the snapshot refers to them.
  static constexpr const char* kChunksName = "mapper.chunks";

  /// Number of inputs after which a new snapshot is due. It limits the time to replay the journal
  /// to a tenth of a second, or less than a second in a large map.
  static constexpr int kSnapshotPeriod = 3000;

  /// Resumes the map in `place`, which must outlive this. Throws io::FileError.
  JournaledMapper(const io::Config& config, std::int64_t config_hash, io::MapFolderLock& place,
                  int snapshot_period = kSnapshotPeriod);

  std::string_view name() const override { return mapper_->name(); }
  std::vector<bus::Channel> inputs() const override { return mapper_->inputs(); }
  bus::InputNeed need_of(bus::Channel channel) const override { return mapper_->need_of(channel); }
  void handle(const bus::Message& input, const bus::Outbox& send) override;
  void flush(const bus::Outbox& send) override;
  bus::NodeCounts counts() const override { return mapper_->counts(); }
  std::string waiting_for() const override { return mapper_->waiting_for(); }
  std::string warning() const override;

  /// Writes the inputs since the last call to the journal, and a snapshot if one is due. Throws
  /// io::FileError when the inputs cannot be written, or when they would take the disk space
  /// reserved for the map.
  void commit();

  /// Sets a function to be called before a map is set aside, so that its files can be saved in
  /// their last state.
  void before_new_map(std::function<void(const MapperNode&)> hook) {
    before_new_map_ = std::move(hook);
  }

  const MapperNode& mapper() const { return *mapper_; }

  /// Number of inputs restored from earlier processes, by channel.
  const std::array<std::int64_t, bus::kNumChannels>& num_replayed() const { return num_replayed_; }

  /// One sentence for each earlier map that was set aside.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  std::string resume();
  std::string resume_from_snapshot(const io::Snapshot& snapshot);
  std::string resume_from_journal(bool has_snapshot, std::uint64_t covered_bytes);
  void replay(std::uint64_t from_bytes);
  void save_snapshot();
  bool is_snapshot_due() const;
  void persist(mapping::StateArchive& archive);
  std::int64_t journal_identity() const;
  void begin_new_map(const std::string& why);
  void note_pose(const pose::PoseEstimate& pose);
  std::vector<std::uint8_t> journal_bytes(const bus::Message& input) const;

  io::Config config_;
  std::int64_t config_hash_;
  io::MapFolderLock& place_;
  int snapshot_period_;
  std::shared_ptr<io::FileChunkAllocator> memory_;
  std::unique_ptr<MapperNode> mapper_;
  std::unique_ptr<io::Journal> journal_;
  std::function<void(const MapperNode&)> before_new_map_;
  std::uint64_t journal_number_ = 0;
  int num_since_snapshot_ = 0;
  std::size_t num_rebuilt_ = 0;  ///< num_rebuilt() at the last snapshot
  bool is_flushed_ = false;      ///< no input since the last flush
  std::array<std::int64_t, bus::kNumChannels> num_replayed_{};
  std::array<std::int64_t, bus::kNumChannels> num_taken_{};  ///< by all processes
  std::optional<pose::PoseEstimate> last_pose_;
  std::vector<std::string> notes_;
};

}  // namespace orchard::procs
