// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/live_node.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>
#include <stdexcept>

namespace orchard::bus {
namespace {

/// Pictures that wait for a slow node; beyond it the oldest is dropped, since the newest matter.
constexpr int kImagesWaiting = 4;

/// Between two live saves of map.csv: what a killed process may lose.
constexpr std::chrono::seconds kSavePeriod{1};

/// Between two live saves of everything, which may take a tenth of a second: a scan in three
/// hundred at 10 Hz can meet one.
constexpr std::chrono::seconds kFullSavePeriod{30};

/// How long a due save lets waiting messages go first.
constexpr std::chrono::milliseconds kSaveDelayMost{100};

/// Messages taken from LCM before one is handed over, so that a flood cannot starve the node.
constexpr int kDrainMost = 200;

const char* publisher_of(Channel channel) {
  switch (channel) {
    case Channel::kScan:
      return "a laser driver or orchard-sim-driver";
    case Channel::kImage:
      return "a camera driver or orchard-sim-driver";
    case Channel::kOdometry:
      return "an odometry driver or orchard-sim-driver";
    case Channel::kGnss:
      return "a GNSS driver";
    case Channel::kPoseFix:
      return "orchard-sim-driver or who knows the robot's position";
    case Channel::kImu:
      return "an IMU driver";
    case Channel::kPose:
    case Channel::kTrajectory:
      return "orchard-pose";
    case Channel::kDetections:
    case Channel::kAdaptation:
      return "orchard-detector";
    case Channel::kMap:
      return "orchard-mapper";
    default:
      return "another process";
  }
}

}  // namespace

LiveNode::LiveNode(Bus& bus, Node& node, const std::string& name, const io::EffectiveConfig& config,
                   SaveHook save)
    : bus_(bus),
      node_(node),
      host_(node, [&bus](Output&& output) { bus.publish(output.channel, output.bytes); }),
      report_(bus, name, config),
      save_(std::move(save)),
      next_save_(Clock::now() + kSavePeriod),
      next_full_save_(Clock::now() + kFullSavePeriod),
      start_(Clock::now()) {
  for (const Channel channel : node.inputs()) {
    bus_.subscribe(channel, [this](const Message& message, Bytes) { take(message); });
  }
}

void LiveNode::run(StopSignal& stop) {
  while (!stop.raised()) {
    if (report_.due()) {
      log_missing_inputs();
      report_.send(status());
    }
    drain();
    save_when_due();
    if (inbox_.empty()) {
      int timeout_ms = report_.ms_until_due();
      if (save_ && changed_) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(next_save_ - Clock::now());
        timeout_ms = std::clamp<int>(static_cast<int>(left.count()), 0, timeout_ms);
      }
      if (!stop.wait(bus_.fileno(), timeout_ms)) continue;
      drain();
    }
    handle_oldest();
  }
  // What was sent before the stop still counts, and LCM's thread may not have read it all.
  const Clock::time_point end = Clock::now() + std::chrono::seconds(2);
  while (Clock::now() < end && bus_.handle(30)) {
  }
  while (!inbox_.empty()) handle_oldest();
  host_.flush();
  const std::string not_saved = save_now(SaveKind::kFinal);
  report_.send(status());
  spdlog::info("stopped: {} messages used, {} sent, {} refused, {} lost", host_.num_handled(),
               host_.num_published(), bus_.counts().num_bad(), host_.sequence_counts().num_lost);
  if (!not_saved.empty()) throw std::runtime_error("the last save failed: " + not_saved);
}

void LiveNode::log_missing_inputs() {
  // To the log when it changes; STATUS repeats it every second.
  std::string missing;
  for (const Channel channel : node_.inputs()) {
    if (host_.seen(channel)) continue;
    missing += (missing.empty() ? "" : ", ") + std::string(info(channel).name) + " (sent by " +
               publisher_of(channel) + ")";
  }
  if (missing == logged_missing_) return;
  logged_missing_ = missing;
  if (missing.empty()) {
    spdlog::info("all inputs have come");
  } else {
    spdlog::info("waiting for {}", missing);
  }
}

void LiveNode::take(const Message& message) {
  const bool is_image = channel_of(message) == Channel::kImage;
  if (is_image && num_images_ >= kImagesWaiting) {
    const auto oldest = std::find_if(inbox_.begin(), inbox_.end(), [](const auto& waiting) {
      return channel_of(waiting.second) == Channel::kImage;
    });
    inbox_.erase(oldest);
    --num_images_;
  }
  num_images_ += is_image ? 1 : 0;
  inbox_.emplace_back(Clock::now(), message);
}

void LiveNode::drain() {
  for (int i = 0; i < kDrainMost && bus_.handle(0); ++i) {
  }
}

void LiveNode::handle_oldest() {
  if (inbox_.empty()) return;
  const auto [arrival, message] = std::move(inbox_.front());
  inbox_.pop_front();
  if (channel_of(message) == Channel::kImage) --num_images_;
  if (host_.receive(message)) changed_ = true;
  report_.note_input(std::chrono::duration<double>(Clock::now() - arrival).count());
}

void LiveNode::save_when_due() {
  if (!save_ || !changed_) return;
  const bool idle = inbox_.empty();
  const Clock::time_point now = Clock::now();
  if (now < (idle ? next_save_ : next_save_ + kSaveDelayMost)) return;
  next_save_ = now + kSavePeriod;
  const bool full = idle && now >= next_full_save_;
  save_now(full ? SaveKind::kFull : SaveKind::kQuick);
  if (full) next_full_save_ = Clock::now() + kFullSavePeriod;
}

std::string LiveNode::save_now(SaveKind kind) {
  if (!save_) return {};
  changed_ = false;
  SaveRequest request{kind, host_.traffic()};
  request.traffic.num_rejected = bus_.counts().num_rejected;
  try {
    save_(node_, request);
    report_.set_error("");
    return {};
  } catch (const std::exception& error) {
    // A full disk must not end the mapping; the last good file stays.
    spdlog::error("not saved: {}", error.what());
    report_.set_error(std::string("not saved: ") + error.what());
    return error.what();
  }
}

Status LiveNode::status() const {
  const SequenceCounts sequence = host_.sequence_counts();
  const NodeCounts counts = node_.counts();
  Status status;
  status.num_good = host_.num_handled();
  status.num_bad = bus_.counts().num_bad() + counts.num_unusable + sequence.num_leaps;
  status.num_lost = sequence.num_lost;
  status.num_late = counts.num_late + sequence.num_reordered;
  status.num_duplicate = sequence.num_duplicate;
  status.num_published = host_.num_published();
  status.text = waiting_text();
  status.level = !status.text.empty() ? Level::kWaiting : Level::kOk;
  if (const std::string warning = node_.warning(); !warning.empty()) {
    status.level = Level::kWarning;
    status.text = warning + (status.text.empty() ? "" : "; " + status.text);
  }
  if (bus_.counts().num_bad() > 0) {
    if (status.level == Level::kOk) status.level = Level::kWarning;
    status.text += status.text.empty() ? "refused" : "; refused";
    for (std::size_t i = 0; i < kNumReasons; ++i) {
      if (const std::int64_t count = bus_.counts().num_rejected[i]) {
        status.text +=
            " " + std::string(to_string(static_cast<Reason>(i))) + "=" + std::to_string(count);
      }
    }
  }
  return status;
}

std::string LiveNode::waiting_text() const {
  std::string text = node_.waiting_for();
  const auto elapsed = std::chrono::duration_cast<std::chrono::seconds>(Clock::now() - start_);
  for (const Channel channel : node_.inputs()) {
    if (host_.seen(channel)) continue;
    text += (text.empty() ? "" : "; ") + std::string("no ") + std::string(info(channel).name) +
            " since the start " + std::to_string(elapsed.count()) + " s ago (sent by " +
            publisher_of(channel) + ")";
  }
  return text;
}

}  // namespace orchard::bus
