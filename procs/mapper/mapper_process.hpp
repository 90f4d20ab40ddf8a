// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bus/node/node.hpp"
#include "bus/process/process.hpp"
#include "io/config/config.hpp"
#include "io/journal.hpp"
#include "io/map/map_folder_lock.hpp"
#include "mapper/mapper_node.hpp"

namespace orchard::procs {

/// Writes the files of a mapper process, always of the finished map: map.csv when the map has
/// changed, of a large map less often, and the whole folder when the drive has grown by an eighth
/// and at the end.
class MapSaver {
 public:
  /// With an empty `folder` nothing is saved.
  MapSaver(std::string folder, std::int64_t config_hash)
      : folder_(std::move(folder)), config_hash_(config_hash) {}

  /// Takes the map to be saved, and returns its writing (bus::SaveHook), which may run in another
  /// thread. It saves map.csv first, since it fits on a disk where the others do not; it throws
  /// io::FileError and then leaves all other files as they were.
  bus::Writing save(const MapperNode& mapper, const bus::SaveRequest& request);

  /// Sets warnings for summary.json in addition to the mapper's own.
  void set_notes(std::vector<std::string> notes) { notes_ = std::move(notes); }

  /// Forgets the saved map, of which nothing is written any more: the next save is of another one.
  void begin_new_map();

 private:
  /// What writings of one map know of each other.
  struct Saved {
    std::mutex writing;
    std::string table;  ///< content of map.csv in the folder; empty: unknown
    std::int64_t newest_number =
        0;  ///< of the writings so far; the last when another map has begun
    std::optional<std::size_t> num_poses_in_all;  ///< in the whole folder; none: not yet written
  };
  /// Whether a writing is newer than those so far, and does not undo one; remembers it.
  static bool is_newest(std::int64_t number, Saved& saved) {
    return number > std::exchange(saved.newest_number, std::max(number, saved.newest_number));
  }
  static void write_table(const std::string& folder, std::string table, Saved& saved);
  /// Number of poses in the whole folder as last written; none: it was not.
  std::optional<std::size_t> num_poses_in_all() const;
  bus::Writing save_table(const std::vector<mapping::Landmark>& landmarks) const;
  bus::Writing save_folder(const MapperNode& mapper, const bus::TrafficCounts& traffic) const;

  std::string folder_;
  std::int64_t config_hash_;
  std::vector<std::string> notes_;
  std::shared_ptr<Saved> saved_ = std::make_shared<Saved>();
  std::size_t num_passed_over_ = 0;  ///< saves of map.csv since the last
  std::int64_t num_saves_ = 0;
};

/// A mapper that can resume its map after a restart: beside the map it keeps a journal of all its
/// inputs, and start() replays it. The map is a function of its inputs, so it continues exactly as
/// without the restart, with the same ids.
///
/// A map without a journal, of another configuration or with a damaged journal is not continued: it
/// is set aside. So is a map whose frame ended because orchard-pose restarted in a mode with its
/// own origin. STATUS and summary.json report it.
class JournaledMapper : public bus::Node {
 public:
  static constexpr const char* kJournalName = "mapper.journal";

  /// A mapper for the map in `place`, which must outlive this; it begins with start().
  JournaledMapper(const io::Config& config, std::int64_t config_hash, io::MapFolderLock& place);

  std::string_view name() const override { return mapper_->name(); }
  std::vector<bus::Channel> inputs() const override { return mapper_->inputs(); }
  bus::InputNeed need_of(bus::Channel channel) const override { return mapper_->need_of(channel); }
  void start(const std::function<void()>& on_progress) override;
  void handle(const bus::Message& input, const bus::Outbox& send) override;
  void flush(const bus::Outbox& send) override;
  std::map<bus::Channel, std::int64_t> resumed() const override { return resumed_; }
  bus::NodeCounts counts() const override { return mapper_->counts(); }
  std::string waiting_for() const override { return mapper_->waiting_for(); }
  std::string warning() const override;
  std::vector<Finding> findings() const override { return mapper_->findings(); }

  /// Returns the writing of the inputs so far to the journal, which may run in another thread. It
  /// throws io::FileError when they cannot be written, or when they would take the disk space
  /// reserved for the map.
  bus::Writing commit() const;

  /// Sets a function to be called before a map is set aside, so that its files can be saved in
  /// their last state.
  void before_new_map(std::function<void(const MapperNode&)> hook) {
    before_new_map_ = std::move(hook);
  }

  const MapperNode& mapper() const { return *mapper_; }

  /// Number of inputs restored from earlier processes, by channel.
  const std::array<std::int64_t, bus::kNumChannels>& num_replayed() const { return num_replayed_; }

  /// One sentence for each earlier map that was set aside, and for what this one lacks.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  std::string resume(const std::function<void()>& on_progress);
  io::JournalReading replay(const std::function<void()>& on_progress);
  bool take_in(std::uint8_t kind, std::string_view bytes);
  void begin_new_map(const std::string& why);
  void make_mapper();
  void add_note(std::string note);
  void note_pose(const pose::PoseEstimate& pose);
  std::vector<std::uint8_t> journal_bytes(const bus::Message& input) const;

  io::Config config_;
  std::int64_t config_hash_;
  io::MapFolderLock& place_;
  std::unique_ptr<MapperNode> mapper_;
  std::shared_ptr<io::Journal> journal_;  ///< from start() on
  std::function<void(const MapperNode&)> before_new_map_;
  std::array<std::int64_t, bus::kNumChannels> num_replayed_{};
  std::int64_t epoch_ = 0;  ///< of the journal's last record
  std::map<bus::Channel, std::int64_t> resumed_;
  std::optional<pose::PoseEstimate> last_pose_;
  std::vector<std::string> notes_;
};

/// The file side of a mapper process: the folder of its map, its journal and its saves.
class MapperProcess {
 public:
  /// Makes the node; with a folder, one that resumes the map in it (a lockstep replay always starts
  /// a new map). Throws std::runtime_error when the folder cannot be written.
  std::unique_ptr<bus::Node> make_node(const io::Config& config, std::int64_t config_hash,
                                       const std::string& folder, bool lockstep);

  /// Takes what is to be saved of the node of make_node(); its writing throws io::FileError after
  /// saving as much as possible.
  bus::Writing save(bus::Node& node, const bus::SaveRequest& request);

 private:
  std::optional<io::MapFolderLock> place_;
  std::optional<MapSaver> saver_;
};

}  // namespace orchard::procs
