// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/journaled_mapper.hpp"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <exception>
#include <utility>
#include <variant>

#include "bus/messages/codec.hpp"
#include "io/file_error.hpp"

namespace orchard::procs {
namespace {

/// Record kind of a flush; all other kinds are channel numbers.
constexpr std::uint8_t kFlushRecord = 255;

/// Disk space that the journal leaves for the map's own files.
constexpr std::uint64_t kReserved_bytes = 4u << 20;

/// Max number of earlier maps in STATUS; the log has all.
constexpr std::size_t kNotesMax = 10;

const char* const kOtherConfiguration = "it was made with another configuration";
const char* const kOtherProgram = "it was made by another version of this program";

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
                                 io::MapFolderLock& place, int snapshot_period)
    : config_(config),
      config_hash_(config_hash),
      place_(place),
      snapshot_period_(snapshot_period),
      memory_(std::make_shared<io::FileChunkAllocator>(place.folder(), kChunksName)),
      mapper_(std::make_unique<MapperNode>(config, memory_)) {
  const std::string why_not = resume();
  if (!why_not.empty()) begin_new_map(why_not);
}

/// Resumes the map in the folder. Returns "" or the reason why it cannot.
std::string JournaledMapper::resume() {
  using State = io::SnapshotReading::State;
  const io::SnapshotReading reading = io::read_snapshot(place_.file(kSnapshotName), config_hash_);
  if (reading.state == State::kOtherMaker) return kOtherConfiguration;
  if (reading.state == State::kDamaged) return "its snapshot is damaged or of another program";
  const bool has_snapshot = reading.state == State::kWhole;
  if (has_snapshot) {
    const std::string why_not = resume_from_snapshot(reading.snapshot);
    if (!why_not.empty()) return why_not;
  }
  return resume_from_journal(has_snapshot, reading.snapshot.journal_bytes);
}

std::string JournaledMapper::resume_from_snapshot(const io::Snapshot& snapshot) {
  if (!memory_->restore(snapshot.chunks)) return std::string(kChunksName) + " is damaged";
  try {
    mapping::StateArchive archive(snapshot.state);
    persist(archive);
    if (archive.num_left() > 0) return kOtherProgram;
  } catch (const std::exception&) {
    return kOtherProgram;
  }
  journal_number_ = snapshot.journal_number;
  num_rebuilt_ = mapper_->num_rebuilt();
  return {};
}

/// The snapshot covers the first `covered_bytes` of the journal with its number. If the process
/// ended right after a snapshot, the journal of the next number is missing or has only its first
/// records.
std::string JournaledMapper::resume_from_journal(bool has_snapshot, std::uint64_t covered_bytes) {
  using State = io::JournalReading::State;
  const std::string path = place_.file(kJournalName);
  io::JournalReading reading = io::read_journal(path, journal_identity(), {}, covered_bytes);
  if (has_snapshot && (reading.state == State::kOtherMaker || reading.state == State::kAbsent)) {
    ++journal_number_;
    covered_bytes = 0;
    reading = io::read_journal(path, journal_identity());
  }
  switch (reading.state) {
    case State::kOtherMaker:
      return kOtherConfiguration;
    case State::kDamaged:
      return "its journal is damaged: " + reading.reason;
    case State::kAbsent:
      if (!has_snapshot) return "it has no journal";
      break;
    case State::kWhole:
      if (reading.num_torn_bytes > 0) {
        spdlog::warn("{}: ignored {} bytes of an interrupted write at the end", path,
                     reading.num_torn_bytes);
      }
      replay(covered_bytes);
  }
  journal_ = std::make_unique<io::Journal>(path, journal_identity(), reading.num_good_bytes);
  if (has_snapshot || reading.num_records > 0) {
    spdlog::info("resuming the map in {}: {} landmarks, {} messages of the journal replayed",
                 place_.folder(), mapper_->num_landmarks(), reading.num_records);
  }
  return {};
}

/// Identifies the journal that belongs to a snapshot.
std::int64_t JournaledMapper::journal_identity() const {
  return config_hash_ ^ static_cast<std::int64_t>(journal_number_ * 0x9E3779B97F4A7C15u);
}

void JournaledMapper::persist(mapping::StateArchive& archive) {
  archive(last_pose_, num_taken_, *mapper_);
  if (archive.is_reading()) num_replayed_ = num_taken_;
}

void JournaledMapper::replay(std::uint64_t from_bytes) {
  const std::string path = place_.file(kJournalName);
  const bus::Outbox nowhere = [](const bus::Message&) {};
  std::int64_t num_refused = 0;
  const auto take_in = [&](std::uint8_t kind, std::string_view bytes) {
    ++num_since_snapshot_;
    if (kind == kFlushRecord) return mapper_->flush(nowhere);
    if (kind >= bus::kNumChannels ||
        bus::info(static_cast<bus::Channel>(kind)).role == bus::Role::kService) {
      ++num_refused;
      return;
    }
    const auto decoded = bus::decode(static_cast<bus::Channel>(kind), bytes.data(), bytes.size());
    const auto* message = std::get_if<bus::Message>(&decoded);
    if (message == nullptr) {
      ++num_refused;
      return;
    }
    ++num_taken_[kind];
    if (const auto* pose = std::get_if<pose::PoseEstimate>(message)) note_pose(*pose);
    mapper_->handle(*message, nowhere);
  };
  io::read_journal(path, journal_identity(), take_in, from_bytes);
  num_replayed_ = num_taken_;
  if (num_refused > 0)
    spdlog::warn("{}: {} messages in it are invalid and were ignored", path, num_refused);
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
    if (notes_.size() < kNotesMax) notes_.push_back(std::move(note));
  }
  mapper_.reset();
  memory_ = std::make_shared<io::FileChunkAllocator>(place_.folder(), kChunksName);
  mapper_ = std::make_unique<MapperNode>(config_, memory_);
  num_replayed_.fill(0);
  num_taken_.fill(0);
  journal_number_ = 0;
  num_since_snapshot_ = 0;
  num_rebuilt_ = 0;
  journal_ = std::make_unique<io::Journal>(place_.file(kJournalName), journal_identity(), 0);
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
  const std::vector<std::uint8_t> bytes = journal_bytes(input);
  journal_->add(static_cast<std::uint8_t>(bus::channel_of(input)), bytes.data(), bytes.size());
  ++num_taken_[static_cast<std::size_t>(bus::channel_of(input))];
  ++num_since_snapshot_;
  is_flushed_ = false;
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
  ++num_since_snapshot_;
  is_flushed_ = true;
  mapper_->flush(send);
}

void JournaledMapper::commit() {
  if (place_.free_bytes() < kReserved_bytes) {
    throw io::FileError(
        fmt::format("{}: less than {} MB are free on the disk, so the journal is stopped: a "
                    "restarted mapper would lose all later messages; free disk space",
                    place_.file(kJournalName), kReserved_bytes >> 20));
  }
  journal_->commit();
  if (is_snapshot_due()) save_snapshot();
}

/// Snapshots are due after a flush, after a rebuild of the map, and every snapshot_period_ inputs.
bool JournaledMapper::is_snapshot_due() const {
  if (num_since_snapshot_ == 0) return false;
  return is_flushed_ || num_since_snapshot_ >= snapshot_period_ ||
         mapper_->num_rebuilt() != num_rebuilt_;
}

/// Writes a snapshot. On failure the journal still has everything and grows on.
void JournaledMapper::save_snapshot() {
  num_since_snapshot_ = 0;
  num_rebuilt_ = mapper_->num_rebuilt();
  try {
    memory_->begin_persisting();
    mapping::StateArchive archive;
    persist(archive);
    io::Snapshot snapshot;
    snapshot.chunks = memory_->sync_persistent();
    snapshot.journal_number = journal_number_;
    snapshot.journal_bytes = journal_->num_bytes();
    snapshot.state = archive.bytes();
    io::write_snapshot(place_.file(kSnapshotName), config_hash_, snapshot);
  } catch (const std::exception& error) {
    spdlog::warn("{}: no snapshot was written ({}); the journal is continued", place_.folder(),
                 error.what());
    return;
  }
  memory_->release_others();
  ++journal_number_;
  journal_->begin_anew(journal_identity());
}

std::string JournaledMapper::warning() const {
  std::string warning = mapper_->warning();
  if (!notes_.empty()) warning += (warning.empty() ? "" : "; ") + notes_.back();
  return warning;
}

}  // namespace orchard::procs
