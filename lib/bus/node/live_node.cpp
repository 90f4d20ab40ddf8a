// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/live_node.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>
#include <stdexcept>

namespace orchard::bus {
namespace {

/// Period of live saves of map.csv: the most that a killed process can lose.
constexpr std::chrono::seconds kSavePeriod{1};

/// Period of live saves of everything. One may take a tenth of a second, so at 10 Hz one scan in
/// three hundred can be delayed.
constexpr std::chrono::seconds kFullSavePeriod{30};

/// Max delay of a due save in favour of waiting messages.
constexpr std::chrono::milliseconds kSaveDelayMax{100};

/// How often the end of a save's writing is looked for.
constexpr int kWritingPoll_ms = 50;

/// After a stop, messages sent earlier still count although LCM's thread may not have read them
/// all. They are received and then handled for at most these times.
constexpr std::chrono::milliseconds kTakeInMax{500};
constexpr std::chrono::milliseconds kWorkOffMax{1000};
constexpr int kQuiet_ms = 30;

/// Time for which a process that must run alone listens for another at the start, and time in which
/// it still yields to one that was there before.
constexpr std::chrono::milliseconds kLookAround{300};
constexpr std::chrono::seconds kGiveWay{3};

/// Late messages are reported over this many seconds; a few occur at every start.
constexpr std::size_t kLateSeconds = 10;
constexpr std::int64_t kLateFew = 2;

/// Max number of messages read from LCM before one is handled, so that a flood cannot starve the
/// node.
constexpr int kDrainMax = 200;

const char* publisher_of(Channel channel) {
  switch (channel) {
    case Channel::kScan:
    case Channel::kScanRear:
      return "a laser driver or orchard-sim-driver";
    case Channel::kImage:
      return "a camera driver or orchard-sim-driver";
    case Channel::kOdometry:
      return "an odometry driver or orchard-sim-driver";
    case Channel::kGnss:
      return "a GNSS driver";
    case Channel::kPoseFix:
      return "orchard-sim-driver or a positioning system";
    case Channel::kImu:
      return "an IMU driver";
    case Channel::kPose:
    case Channel::kTrajectory:
      return "orchard-pose";
    case Channel::kDetections:
      return "orchard-detector";
    case Channel::kMap:
    case Channel::kMapWays:
      return "orchard-mapper";
    default:
      return "another process";
  }
}

}  // namespace

LiveNode::LiveNode(Bus& bus, Node& node, const std::string& name, const io::EffectiveConfig& config,
                   SaveHook save, bool alone)
    : bus_(bus),
      node_(node),
      host_(node, [&bus](Output&& output) { bus.publish(output.channel, output.bytes); }),
      report_(bus, name, config),
      save_(std::move(save)),
      next_save_(Clock::now() + kSavePeriod),
      next_full_save_(Clock::now() + kFullSavePeriod),
      start_(Clock::now()),
      inbox_(node.need_of(Channel::kImage) != InputNeed::kOptional),
      peers_(name, report_.host(), config.hash),
      alone_(alone) {
  for (const Channel channel : node.inputs()) {
    bus_.subscribe(channel,
                   [this](Message&& message, Bytes bytes) { take(std::move(message), bytes); });
  }
  bus_.subscribe_status([this](const Status& status) {
    // A new process learns of this one at once instead of within a second.
    if (peers_.note(status, wall_utime(), Clock::now())) report_.send_soon(true);
    node_.handle_status(status);
  });
  bus_.subscribe_config([this](const ConfigNotice& notice) { peers_.note(notice, Clock::now()); });
}

void LiveNode::run(StopSignal& stop) {
  if (alone_) check_peers(stop);
  node_.start([this] {  // what arrives meanwhile waits
    drain();
    if (report_.due()) report();
  });
  for (const auto& [channel, drive_time] : node_.resumed()) host_.resume(channel, drive_time);
  has_started_ = true;
  while (!stop.raised()) {
    drain();
    if (inputs_.update(Clock::now())) report_.send_soon(false);
    if (report_.due()) report();
    save_when_due();
    if (!handle_next()) wait(stop);
  }
  process_arrived();
  host_.flush();
  end_save();
  begin_save(SaveKind::kFinal);
  end_save();
  report_.send(status());
  spdlog::info("stopped: {} messages used, {} sent, {} refused, {} lost", host_.num_handled(),
               host_.num_published(), bus_.counts().num_bad(), host_.sequence_counts().num_lost);
  if (!save_mistake_.empty()) throw std::runtime_error("the final save failed: " + save_mistake_);
}

/// Waits until a message arrives, STATUS or a save is due, or an input has been silent for too
/// long.
void LiveNode::wait(StopSignal& stop) {
  const Clock::time_point now = Clock::now();
  int timeout_ms = std::min(report_.ms_until_due(), inputs_.ms_until_change(now));
  if (const auto ms = inbox_.ms_until_next(now)) timeout_ms = std::min(timeout_ms, *ms);
  if (writing_.valid()) {
    timeout_ms = std::min(timeout_ms, kWritingPoll_ms);
  } else if (save_ && changed_) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(next_save_ - now);
    timeout_ms = std::clamp<int>(static_cast<int>(left.count()), 0, timeout_ms);
  }
  stop.wait(bus_.fileno(), timeout_ms);
}

void LiveNode::process_arrived() {
  const Clock::time_point taken_in = Clock::now() + kTakeInMax;
  while (Clock::now() < taken_in && bus_.handle(kQuiet_ms)) {
  }
  inbox_.release_all();
  const Clock::time_point worked_off = Clock::now() + kWorkOffMax;
  while (Clock::now() < worked_off && handle_next()) {
  }
  if (inbox_.size() > 0)
    spdlog::warn("stopped with {} received messages not processed", inbox_.size());
}

void LiveNode::check_peers(StopSignal& stop) {
  const Clock::time_point end = Clock::now() + kLookAround;
  report_.send(status());  // processes already running answer
  while (!stop.raised() && Clock::now() < end) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now());
    if (stop.wait(bus_.fileno(), static_cast<int>(left.count()))) drain();
    require_single_instance();
  }
}

/// A process that has run for a while continues in any case, because a STATUS may be a recorded
/// one.
void LiveNode::require_single_instance() const {
  const Clock::time_point now = Clock::now();
  if (!alone_ || now - start_ > kGiveWay) return;
  if (!peers_.duplicate_is_older(report_.num_sent(), now)) return;
  throw std::runtime_error(peers_.duplicate(now) + " is already running on " + bus_.url() +
                           ": stop it first, or give each robot a name with --robot");
}

void LiveNode::report() {
  require_single_instance();
  log_missing_inputs();
  for (const Channel channel : node_.inputs()) {
    inputs_.count(channel, host_.sequence_counts(channel), host_.num_used(channel));
  }
  if (const double step_s = peers_.check_clock(wall_utime(), Clock::now()); step_s != 0.0) {
    spdlog::warn("the clock of this machine was changed by {:+.1f} s", step_s);
  }
  const std::int64_t num_dropped = inbox_.num_dropped();
  num_dropped_lately_ = num_dropped - std::exchange(num_dropped_before_, num_dropped);
  num_late_.push_back(node_.counts().num_late);
  if (num_late_.size() > kLateSeconds + 1) num_late_.pop_front();
  const std::int64_t num_published = host_.num_published();
  outputs_flow_ = num_published > std::exchange(num_published_before_, num_published);
  report_.send(status());
  waited_for_before_ = node_.waiting_for();
}

void LiveNode::log_missing_inputs() {
  // Logged only when it changes; STATUS repeats it every second.
  std::string missing;
  for (const Channel channel : node_.inputs()) {
    if (host_.seen(channel) || node_.need_of(channel) != InputNeed::kRequired) continue;
    missing += (missing.empty() ? "" : ", ") + std::string(info(channel).name) + " (sent by " +
               publisher_of(channel) + ")";
  }
  if (missing == logged_missing_) return;
  logged_missing_ = missing;
  if (missing.empty()) {
    spdlog::info("all inputs are arriving");
  } else {
    spdlog::info("waiting for {}", missing);
  }
}

void LiveNode::take(Message&& message, Bytes bytes) {
  const Clock::time_point now = Clock::now();
  const Channel channel = channel_of(message);
  if (node_.need_of(channel) != InputNeed::kOccasional) inputs_.note(channel, now);
  inbox_.add({now, std::move(message), bytes.size});
}

void LiveNode::drain() {
  for (int i = 0; i < kDrainMax && bus_.handle(0); ++i) {
  }
}

bool LiveNode::handle_next() {
  auto arrival = inbox_.take(Clock::now());
  if (!arrival) return false;
  const auto arrival_us =
      std::chrono::duration_cast<std::chrono::microseconds>(arrival->time.time_since_epoch());
  if (host_.receive(std::move(arrival->message), arrival_us.count())) changed_ = true;
  report_.note_input(std::chrono::duration<double>(Clock::now() - arrival->time).count());
  return true;
}

void LiveNode::save_when_due() {
  const auto has_ended = [this] {
    return writing_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  };
  if (writing_.valid() && has_ended()) end_save();
  if (!save_ || !changed_ || writing_.valid()) return;
  const bool idle = inbox_.size() == 0;
  const Clock::time_point now = Clock::now();
  if (now < (idle ? next_save_ : next_save_ + kSaveDelayMax)) return;
  next_save_ = now + kSavePeriod;
  const bool full = idle && now >= next_full_save_;
  begin_save(full ? SaveKind::kFull : SaveKind::kQuick);
  if (full) next_full_save_ = Clock::now() + kFullSavePeriod;
}

/// Takes from the node what is to be saved, and begins to write it beside the node.
void LiveNode::begin_save(SaveKind kind) {
  if (!save_) return;
  changed_ = false;
  SaveRequest request{kind, host_.traffic()};
  request.traffic.num_rejected = bus_.counts().num_rejected;
  try {
    if (Writing write = save_(node_, request)) {
      writing_ = std::async(std::launch::async, std::move(write));
    } else {
      note_outcome("");
    }
  } catch (const std::exception& error) {
    note_outcome(error.what());
  }
}

/// Waits for the writing of the last save.
void LiveNode::end_save() {
  if (!writing_.valid()) return;
  try {
    writing_.get();
    note_outcome("");
  } catch (const std::exception& error) {
    note_outcome(error.what());
  }
}

/// Reports how a save ended. A full disk must not end the mapping; the last good file remains.
void LiveNode::note_outcome(std::string mistake) {
  report_.set_error(mistake.empty() ? "" : "not saved: " + mistake);
  if (!mistake.empty()) {
    spdlog::error("not saved: {}", mistake);
    if (save_mistake_.empty()) report_.send_soon(false);
  }
  save_mistake_ = std::move(mistake);
}

Status LiveNode::status() const {
  const SequenceCounts sequence = host_.sequence_counts();
  const NodeCounts counts = node_.counts();
  Status status;
  status.num_good = host_.num_handled();
  status.num_bad = bus_.counts().num_bad() + counts.num_unusable + sequence.num_jumps;
  status.num_lost = sequence.num_lost;
  status.num_late = counts.num_late + sequence.num_reordered;
  status.num_duplicate = sequence.num_duplicate;
  status.num_published = host_.num_published();
  const auto add = [&status](Level level, const std::string& text) {
    if (text.empty()) return;
    status.level = std::max(status.level, level);
    status.text += (status.text.empty() ? "" : "; ") + text;
  };
  const Clock::time_point now = Clock::now();
  if (const std::string duplicate = peers_.duplicate(now); !duplicate.empty()) {
    add(Level::kError,
        duplicate + " runs beside this one (" + report_.host() + "): stop one of them");
  }
  if (!has_started_) add(Level::kWaiting, "starting; what arrives waits");
  add(Level::kWarning, warning_text(node_));
  std::string inputs;
  const Level inputs_level = describe_inputs(inputs);
  add(inputs_level, inputs);
  add(Level::kWaiting, waiting_text());
  add(Level::kWarning, peers_.text(now));
  if (!num_late_.empty() && num_late_.back() - num_late_.front() > kLateFew) {
    add(Level::kWarning, std::to_string(num_late_.back() - num_late_.front()) +
                             " messages of the last " + std::to_string(kLateSeconds) +
                             " s arrived too late to be used");
  }
  if (num_dropped_lately_ > 0) {
    add(Level::kWarning,
        std::to_string(num_dropped_lately_) +
            " messages dropped in the last second: they arrive faster than they can be processed");
  }
  if (bus_.counts().num_bad() > 0) {
    std::string refused = "refused";
    for (std::size_t i = 0; i < kNumReasons; ++i) {
      if (const std::int64_t count = bus_.counts().num_rejected[i]) {
        refused +=
            " " + std::string(to_string(static_cast<Reason>(i))) + "=" + std::to_string(count);
      }
    }
    add(Level::kWarning, refused);
  }
  return status;
}

Level LiveNode::describe_inputs(std::string& text) const {
  Level level = Level::kOk;
  const Clock::time_point now = Clock::now();
  for (const Channel channel : node_.inputs()) {
    std::string said = inputs_.text(channel, now);
    if (said.empty()) continue;
    if (inputs_.is_serious(channel)) level = Level::kWarning;
    if (inputs_.has_two_sources(channel)) {
      const std::string part =
          info(channel).role == Role::kSource ? "driver" : std::string(publisher_of(channel));
      const std::string who = peers_.named(part, now);
      if (!who.empty()) said += " (" + who + ")";
    } else if (inputs_.is_stale(channel)) {
      said += " (sent by " + std::string(publisher_of(channel)) + ")";
    }
    text += (text.empty() ? "" : "; ") + said;
  }
  return level;
}

/// Waiting is reported only when nothing was sent or the text is the same as a second ago; short
/// waits are normal.
std::string LiveNode::waiting_text() const {
  std::string text = node_.waiting_for();
  if (outputs_flow_ && text != waited_for_before_) text.clear();
  const auto elapsed = std::chrono::duration_cast<std::chrono::seconds>(Clock::now() - start_);
  for (const Channel channel : node_.inputs()) {
    if (host_.seen(channel) || node_.need_of(channel) != InputNeed::kRequired) continue;
    text += (text.empty() ? "" : "; ") + std::string("no ") + std::string(info(channel).name) +
            " since the start " + std::to_string(elapsed.count()) + " s ago (sent by " +
            publisher_of(channel) + ")";
  }
  return text;
}

}  // namespace orchard::bus
