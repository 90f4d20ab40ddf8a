// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/mapper_process.hpp"

#include <fmt/core.h>
#include <malloc.h>
#include <spdlog/spdlog.h>
#include <charconv>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <utility>
#include <variant>

#include "bus/messages/codec.hpp"
#include "bus/node/process_options.hpp"
#include "io/atomic_file.hpp"
#include "io/file_chunk_allocator.hpp"
#include "io/file_error.hpp"
#include "io/map/map_csv.hpp"
#include "io/map/map_folder.hpp"
#include "timing/drive_time.hpp"

namespace orchard::procs {
namespace {

/// derived: Max number of landmarks for saving the whole folder in a running process. Finishing
/// more takes over 0.1 s, during which the node waits; these are saved at the end.
constexpr std::size_t kDrawnLiveMax = 3000;

/// derived: One save of map.csv is passed over per this many landmarks: finishing a large map takes
/// long.
constexpr std::size_t kSavedEachTime = 1000;

/// derived: The whole folder holds the whole drive: written each time that it has grown by an
/// eighth, a pose is written nine times, however long the drive.
constexpr std::size_t kGrowthParts = 8;

}  // namespace

bus::Writing MapSaver::save(const MapperNode& mapper, const bus::SaveRequest& request) {
  if (folder_.empty()) return {};
  ++num_saves_;
  // The first save writes all files while the map is still small, so that users find every file.
  const std::optional<std::size_t> before = num_poses_in_all();
  const bool is_live = request.kind != bus::SaveKind::kFinal && before.has_value();
  const bool is_quick = request.kind == bus::SaveKind::kQuick ||
                        mapper.num_landmarks() > kDrawnLiveMax ||
                        mapper.num_poses() < before.value_or(0) + before.value_or(0) / kGrowthParts;
  if (is_live && is_quick) {
    if (num_passed_over_++ < mapper.num_landmarks() / kSavedEachTime) return {};
    num_passed_over_ = 0;
    return save_table(mapper.finished_landmarks());
  }
  return save_folder(mapper, request.traffic);
}

std::optional<std::size_t> MapSaver::num_poses_in_all() const {
  const std::lock_guard lock(saved_->writing);
  return saved_->num_poses_in_all;
}

void MapSaver::begin_new_map() {
  {
    const std::lock_guard lock(saved_->writing);
    saved_->newest_number = std::numeric_limits<std::int64_t>::max();
  }
  saved_ = std::make_shared<Saved>();
  num_passed_over_ = 0;
}

void MapSaver::write_table(const std::string& folder, std::string table, Saved& saved) {
  if (table == saved.table) return;
  io::write_file_atomically((std::filesystem::path(folder) / "map.csv").string(), table);
  saved.table = std::move(table);
}

bus::Writing MapSaver::save_table(const std::vector<mapping::Landmark>& landmarks) const {
  return [folder = folder_, table = io::map_csv(landmarks), saved = saved_,
          number = num_saves_]() mutable {
    const std::lock_guard lock(saved->writing);
    if (is_newest(number, *saved)) write_table(folder, std::move(table), *saved);
  };
}

bus::Writing MapSaver::save_folder(const MapperNode& mapper,
                                   const bus::TrafficCounts& traffic) const {
  io::MapSummary summary;
  summary.source = "live";
  summary.config_hash = config_hash_;
  summary.version = bus::version();
  summary.counts = bus::named_counts(traffic, {&mapper});
  summary.warnings = notes_;
  if (std::string warning = mapper.warning(); !warning.empty()) {
    summary.warnings.push_back(std::move(warning));
  }
  auto content = std::make_shared<io::MapFolderContent>(mapper.content(summary));
  if (!content->trajectory.empty()) {
    content->summary.first_utime = content->trajectory.front().utime;
    content->summary.last_utime = content->trajectory.back().utime;
  }
  return [folder = folder_, content, saved = saved_, number = num_saves_,
          num_poses = mapper.num_poses()]() mutable {
    const std::lock_guard lock(saved->writing);
    if (!is_newest(number, *saved)) return;
    std::error_code ignored;  // the write below reports it
    std::filesystem::create_directories(folder, ignored);
    std::string table = io::map_csv(content->landmarks);
    write_table(folder, table, *saved);
    io::write_map_folder(folder, *content);
    saved->table = std::move(table);
    saved->num_poses_in_all = num_poses;
    // The content of a long drive takes tens of megabytes, which the allocator would keep.
    content.reset();
    ::malloc_trim(0);
  };
}

namespace {

/// Record kinds of a flush, and of the epoch of the drive times after it in digits: messages hold
/// their utime alone. The others are channel numbers.
constexpr std::uint8_t kFlushRecord = 255;
constexpr std::uint8_t kEpochRecord = 253;

/// derived: Disk space that the journal leaves for the map's own files.
constexpr std::uint64_t kReserved_bytes = 4u << 20;

/// derived: Max number of earlier maps in STATUS; the log has all.
constexpr std::size_t kNotesMax = 10;

/// Files of a program that kept only the inputs since a snapshot of its state in the journal.
constexpr const char* kSnapshotName = "mapper.snapshot";
constexpr const char* kChunksName = "mapper.chunks";

/// derived: Number of replayed records between two calls of on_progress(): some hundredths of a
/// second.
constexpr std::int64_t kProgressPeriod = 500;

/// True if the frame of the poses survives a restart of orchard-pose: it is given from outside, not
/// by the robot's start.
bool frame_is_given(const pose::PoseConfig& config) {
  switch (config.mode) {
    case pose::PoseMode::kOdometry:
    case pose::PoseMode::kSlam:
      return false;
    case pose::PoseMode::kFused:
      return config.gnss.datum != std::array<double, 3>{};
    default:
      return true;
  }
}

}  // namespace

JournaledMapper::JournaledMapper(const io::Config& config, std::int64_t config_hash,
                                 io::MapFolderLock& place)
    : config_(config), config_hash_(config_hash), place_(place) {
  make_mapper();
}

void JournaledMapper::make_mapper() {
  mapper_ = std::make_unique<MapperNode>(config_,
                                         std::make_shared<io::FileChunkAllocator>(place_.folder()));
  last_pose_.reset();
  num_replayed_.fill(0);
}

void JournaledMapper::start(const std::function<void()>& on_progress) {
  try {
    const std::string why_not = resume(on_progress);
    if (!why_not.empty()) begin_new_map(why_not);
  } catch (const io::FileError& error) {  // a failure to write, not a bad input file
    throw std::runtime_error(error.what());
  }
}

/// Resumes the map in the folder. Returns "" or the reason why it cannot.
std::string JournaledMapper::resume(const std::function<void()>& on_progress) {
  using State = io::JournalReading::State;
  const std::string path = place_.file(kJournalName);
  if (std::filesystem::exists(place_.file(kSnapshotName))) {
    return "an earlier version of this program saved its state in " + std::string(kSnapshotName);
  }
  const io::JournalReading reading = replay(on_progress);
  switch (reading.state) {
    case State::kOtherMaker:
      return "it was made with another configuration";
    case State::kDamaged:
      return "its journal is damaged: " + reading.reason;
    case State::kAbsent:
      return "it has no journal";
    case State::kWhole:
      break;
  }
  if (reading.num_torn_bytes > 0) {
    spdlog::warn("{}: ignored {} bytes of an interrupted write at the end", path,
                 reading.num_torn_bytes);
  }
  if (reading.num_missing > 0) {
    add_note(
        fmt::format("{} messages came while the disk was full and are not in {}: after the "
                    "restart the map lacks what they showed",
                    reading.num_missing, path));
  }
  journal_ = std::make_shared<io::Journal>(path, config_hash_, reading.num_good_bytes);
  if (reading.num_records > 0) {
    spdlog::info("resuming the map in {}: {} landmarks, {} messages of the journal replayed",
                 place_.folder(), mapper_->num_landmarks(), reading.num_records);
  }
  return {};
}

io::JournalReading JournaledMapper::replay(const std::function<void()>& on_progress) {
  const std::string path = place_.file(kJournalName);
  std::int64_t num = 0, num_refused = 0;
  const io::JournalReading reading =
      io::read_journal(path, config_hash_, [&](std::uint8_t kind, std::string_view bytes) {
        if (!take_in(kind, bytes)) ++num_refused;
        if (++num % kProgressPeriod == 0 && on_progress) on_progress();
      });
  if (num_refused > 0)
    spdlog::warn("{}: {} messages in it are invalid and were ignored", path, num_refused);
  return reading;
}

/// Handles a record of the journal again; false if it is invalid.
bool JournaledMapper::take_in(std::uint8_t kind, std::string_view bytes) {
  const bus::Outbox nowhere = [](const bus::Message&) {};
  if (kind == kFlushRecord) {
    mapper_->flush(nowhere);
    return true;
  }
  if (kind == kEpochRecord) {
    std::from_chars(bytes.data(), bytes.data() + bytes.size(), epoch_);
    return epoch_ >= 0 && epoch_ < timing::kEpochsMax;
  }
  const auto channel = static_cast<bus::Channel>(kind);
  if (kind >= bus::kNumChannels || bus::info(channel).role == bus::Role::kService) return false;
  auto decoded = bus::decode(channel, bytes.data(), bytes.size());
  auto* message = std::get_if<bus::Message>(&decoded);
  if (message == nullptr) return false;
  const std::int64_t drive_time = epoch_ * timing::kEpoch_us + bus::utime_of(*message);
  bus::set_drive_time(*message, drive_time);
  resumed_[channel] = drive_time;
  ++num_replayed_[kind];
  if (const auto* pose = std::get_if<pose::PoseEstimate>(message)) note_pose(*pose);
  mapper_->handle(*message, nowhere);
  return true;
}

void JournaledMapper::begin_new_map(const std::string& why) {
  journal_.reset();
  const std::string aside = place_.set_aside({kJournalName, kSnapshotName, kChunksName});
  if (!aside.empty()) {
    std::string note = fmt::format(
        "the earlier map in {} cannot be resumed: {}. A new map was started; the earlier one was "
        "moved to {}",
        place_.folder(), why, aside);
    spdlog::warn("{}", note);
    add_note(std::move(note));
  }
  make_mapper();
  journal_ = std::make_shared<io::Journal>(place_.file(kJournalName), config_hash_, 0);
  epoch_ = 0;
  resumed_.clear();
}

void JournaledMapper::add_note(std::string note) {
  if (notes_.size() < kNotesMax) notes_.push_back(std::move(note));
}

void JournaledMapper::note_pose(const pose::PoseEstimate& pose) {
  if (!last_pose_ || pose.utime > last_pose_->utime) last_pose_ = pose;
}

void JournaledMapper::handle(const bus::Message& input, const bus::Outbox& send) {
  if (const auto* pose = std::get_if<pose::PoseEstimate>(&input)) {
    // Reordered messages have an earlier utime; a later utime with a lower seq comes from a new
    // process.
    const bool is_anew =
        last_pose_ && pose->utime > last_pose_->utime && pose->seq < last_pose_->seq;
    if (is_anew && !frame_is_given(config_.pose)) {
      if (before_new_map_) before_new_map_(*mapper_);
      journal_->commit();
      begin_new_map("orchard-pose was restarted and its frame has another origin");
    } else if (is_anew) {
      spdlog::info("orchard-pose was restarted; its frame is unchanged, and the map is continued");
    }
    note_pose(*pose);
  }
  if (const auto epoch = timing::epoch_of(bus::utime_of(input)); epoch != epoch_) {
    const std::string digits = std::to_string(epoch_ = epoch);
    journal_->add(kEpochRecord, digits.data(), digits.size());
  }
  const std::vector<std::uint8_t> bytes = journal_bytes(input);
  journal_->add(static_cast<std::uint8_t>(bus::channel_of(input)), bytes.data(), bytes.size());
  mapper_->handle(input, send);
}

/// Encodes a message for the journal. A scan of which the mapper uses only the time is cut to one
/// beam, an unused picture to one pixel.
std::vector<std::uint8_t> JournaledMapper::journal_bytes(const bus::Message& input) const {
  const auto* image = std::get_if<vision::Image>(&input);
  if (image != nullptr && !mapper_->keeps_picture_of(image->utime)) {
    return bus::encode(
        vision::Image{image->utime, image->seq, 1, 1, vision::Encoding::kGray8, {0}});
  }
  const auto* scan = std::get_if<laser::Scan>(&input);
  if (scan == nullptr) return bus::encode(input);
  laser::Scan kept = *scan;
  kept.intensities.clear();
  if (!mapper_->keeps_beams_of(scan->utime) && !kept.ranges_m.empty()) kept.ranges_m.resize(1);
  return bus::encode(kept);
}

void JournaledMapper::flush(const bus::Outbox& send) {
  journal_->add(kFlushRecord, nullptr, 0);
  mapper_->flush(send);
}

bus::Writing JournaledMapper::commit() const {
  return [journal = journal_, &place = place_] {
    if (place.free_bytes() < kReserved_bytes) {
      throw io::FileError(
          fmt::format("{}: less than {} MB are free on the disk, so the journal is stopped: a "
                      "restarted mapper would lose all later messages; free disk space",
                      place.file(kJournalName), kReserved_bytes >> 20));
    }
    journal->commit();
  };
}

std::string JournaledMapper::warning() const {
  std::string warning = mapper_->warning();
  if (!notes_.empty()) warning += (warning.empty() ? "" : "; ") + notes_.back();
  return warning;
}

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
      saver_->save(earlier, {bus::SaveKind::kFinal, {}})();
      saver_->begin_new_map();
    });
    return mapper;
  } catch (const io::FileError& error) {  // a failure to write, not a bad input file
    throw std::runtime_error(error.what());
  }
}

bus::Writing MapperProcess::save(bus::Node& node, const bus::SaveRequest& request) {
  auto* journaled = dynamic_cast<JournaledMapper*>(&node);
  if (journaled == nullptr) return saver_->save(dynamic_cast<const MapperNode&>(node), request);
  bus::SaveRequest all = request;
  for (std::size_t i = 0; i < bus::kNumChannels; ++i) {
    all.traffic.num_in[i] += journaled->num_replayed()[i];
  }
  saver_->set_notes(journaled->notes());
  // Write the journal first, so that a restart can restore the map; save the map even if this
  // fails.
  return [commit = journaled->commit(), save = saver_->save(journaled->mapper(), all)] {
    std::string not_kept;
    try {
      commit();
    } catch (const io::FileError& error) {
      not_kept = error.what();
    }
    if (save) save();
    if (!not_kept.empty()) throw io::FileError(not_kept);
  };
}

}  // namespace orchard::procs
