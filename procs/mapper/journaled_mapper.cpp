// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/journaled_mapper.hpp"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <utility>
#include <variant>

#include "bus/messages/codec.hpp"
#include "io/file_error.hpp"

namespace orchard::procs {
namespace {

/// Kind of the record that stands for a flush; the others are numbers of channels.
constexpr std::uint8_t kFlushRecord = 255;

/// What the journal leaves free on the disk for the map's own files.
constexpr std::uint64_t kReserved_bytes = 4u << 20;

/// Earlier maps that STATUS names; all stand in the log.
constexpr std::size_t kNotesMax = 10;

/// Whether the frame of the poses is the same after orchard-pose began anew: told from outside, and
/// not where the robot happened to start.
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
                                 io::MapPlace& place)
    : config_(config),
      config_hash_(config_hash),
      place_(place),
      memory_(std::make_shared<io::FileMemory>(place.folder())),
      mapper_(std::make_unique<MapperNode>(config, memory_)) {
  go_on_or_begin();
}

void JournaledMapper::go_on_or_begin() {
  const std::string path = place_.file(kJournalName);
  const io::JournalReading reading = io::read_journal(path, config_hash_);
  using State = io::JournalReading::State;
  switch (reading.state) {
    case State::kWhole:
      if (reading.num_torn_bytes > 0) {
        spdlog::warn("{}: {} bytes at its end are of a write that was cut off: left out", path,
                     reading.num_torn_bytes);
      }
      replay();
      journal_ = std::make_unique<io::Journal>(path, config_hash_, reading.num_good_bytes);
      return;
    case State::kAbsent:
      return begin_new_map("it has no journal to go on from");
    case State::kOtherMaker:
      return begin_new_map("it was made with another configuration");
    case State::kDamaged:
      return begin_new_map("its journal is damaged: " + reading.reason);
  }
}

void JournaledMapper::replay() {
  const std::string path = place_.file(kJournalName);
  const bus::Outbox nowhere = [](const bus::Message&) {};
  std::int64_t num_records = 0, num_refused = 0;
  io::read_journal(path, config_hash_, [&](std::uint8_t kind, std::string_view bytes) {
    ++num_records;
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
    ++num_replayed_[kind];
    if (const auto* pose = std::get_if<pose::PoseEstimate>(message)) note_pose(*pose);
    mapper_->handle(*message, nowhere);
  });
  if (num_records == 0) return;
  spdlog::info("goes on with the map in {}: {} landmarks from {} messages", place_.folder(),
               mapper_->landmarks().size(), num_records - num_refused);
  if (num_refused > 0) spdlog::warn("{}: {} messages in it are refused", path, num_refused);
}

void JournaledMapper::begin_new_map(const std::string& why) {
  const std::string aside = place_.set_aside({kJournalName});
  if (!aside.empty()) {
    std::string note = fmt::format("an earlier map in {} is not gone on with, as {}; it is in {}",
                                   place_.folder(), why, aside);
    spdlog::warn("{}", note);
    if (notes_.size() < kNotesMax) notes_.push_back(std::move(note));
  }
  num_replayed_.fill(0);
  journal_ = std::make_unique<io::Journal>(place_.file(kJournalName), config_hash_, 0);
}

void JournaledMapper::note_pose(const pose::PoseEstimate& pose) {
  if (!last_pose_ || pose.utime > last_pose_->utime) last_pose_ = pose;
}

void JournaledMapper::handle(const bus::Message& input, const bus::Outbox& send) {
  if (const auto* pose = std::get_if<pose::PoseEstimate>(&input)) {
    // Reordered ones are earlier, too; a later one of a lower number is another process's.
    const bool is_anew =
        last_pose_ && pose->utime > last_pose_->utime && pose->seq < last_pose_->seq;
    if (is_anew && !frame_is_given(config_.pose)) {
      if (before_new_map_) before_new_map_(*mapper_);
      journal_->commit();
      mapper_ = std::make_unique<MapperNode>(config_, memory_);
      begin_new_map("orchard-pose began anew, with another origin");
    } else if (is_anew) {
      spdlog::info("orchard-pose began anew; its frame is given, and the map goes on");
    }
    note_pose(*pose);
  }
  const std::vector<std::uint8_t> bytes = journal_bytes(input);
  journal_->add(static_cast<std::uint8_t>(bus::channel_of(input)), bytes.data(), bytes.size());
  mapper_->handle(input, send);
}

/// A message as the journal keeps it: of a scan that the mapper only takes the time of, one beam.
std::vector<std::uint8_t> JournaledMapper::journal_bytes(const bus::Message& input) const {
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

void JournaledMapper::commit() {
  if (place_.free_bytes() < kReserved_bytes) {
    throw io::FileError(fmt::format(
        "{}: less than {} MB are left on the disk: a mapper that is started again would not know "
        "what came since; make room",
        place_.file(kJournalName), kReserved_bytes >> 20));
  }
  journal_->commit();
}

std::string JournaledMapper::warning() const {
  std::string warning = mapper_->warning();
  if (!notes_.empty()) warning += (warning.empty() ? "" : "; ") + notes_.back();
  return warning;
}

}  // namespace orchard::procs
