// SPDX-License-Identifier: BSD-3-Clause
#include "bus/replay/lockstep.hpp"

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "bus/node/node.hpp"
#include "bus/replay/lockstep_protocol.hpp"
#include "bus/replay/replay_index.hpp"
#include "orchard/ack_t.hpp"

namespace orchard::bus {
namespace {

// derived: by Linux's default, a socket holds 212,992 bytes of datagrams, and a small one takes 768
// of them: the messages of a round fit in even while their reader sleeps.
constexpr std::size_t kRoundMessages = 64;
constexpr std::size_t kRoundBytes = 64u << 10;

using Clock = std::chrono::steady_clock;

struct Stopped {};

struct Participant {
  std::string name;
  std::int8_t number = 0;
  bool present = false;
  bool answered = false;  ///< in this round
  std::set<Channel> inputs;
  LockstepSteps made;  ///< steps of this round that it has made
};

/// One message of a round.
struct Step {
  OutputId id;
  std::int64_t utime = 0;
  std::vector<std::uint8_t> bytes;
};

std::string text_of(const OutputId& id) {
  return std::string(info(id.channel).name) + " seq " + std::to_string(id.seq);
}

/// The player's side of the protocol: one round of source messages and everything derived from it.
class Exchange {
 public:
  Exchange(Bus& bus, StopSignal& stop, const LockstepOptions& options)
      : bus_(bus), stop_(stop), options_(options) {
    for (const std::string& name : options.nodes) {
      Participant participant;
      participant.name = "orchard-" + name;
      participant.number = node_number(name);
      participants_.push_back(std::move(participant));
    }
    for (const ChannelInfo& channel : kChannels) {
      if (channel.role != Role::kDerived) continue;
      bus_.subscribe(channel.channel,
                     [this](const Message& message, Bytes bytes) { on_output(message, bytes); });
    }
    bus_.subscribe_ack([this](const Ack& ack) { on_ack(ack); });
    // Rejected messages of other senders do not matter; a node's own will be missing, and the error
    // message then quotes this reason.
    bus_.on_rejection([this](Channel channel, const Rejection& rejection) {
      last_refusal_ = std::string(info(channel).name) + ": " + rejection.detail;
    });
  }

  /// Repeats BEGIN until every participant has answered.
  void begin(std::int64_t utime) {
    const std::vector<std::uint8_t> mark = encode(ReplayMark{utime, 0, false});
    replay_utime_ = utime;
    const auto end = Clock::now() + std::chrono::seconds(options_.start_timeout_s);
    auto next_word = Clock::now() + std::chrono::seconds(1);
    while (!missing().empty()) {
      if (Clock::now() >= end) {
        throw LockstepError("no answer from " + missing() + " within " +
                            std::to_string(options_.start_timeout_s) +
                            " s: start each with --lockstep on " + bus_.url());
      }
      if (Clock::now() >= next_word) {
        if (options_.say) options_.say("waits for " + missing() + " (started with --lockstep?)");
        next_word += std::chrono::seconds(5);
      }
      bus_.publish(Channel::kReplay, mark);
      const auto pause = Clock::now() + std::chrono::milliseconds(options_.timeout_ms);
      while (!missing().empty() && Clock::now() < pause) wait(pause);
    }
  }

  bool has_consumers(Channel channel) const {
    return std::any_of(participants_.begin(), participants_.end(),
                       [&](const Participant& p) { return p.inputs.count(channel) > 0; });
  }

  /// Sends the messages of a round, repeatedly if needed, until every participant has made all
  /// steps and everything that they sent has arrived.
  void run(const std::vector<Step>& steps) {
    const std::vector<std::uint8_t> announcement = start_round(steps);
    // A flush may save the map of a whole day on a busy machine.
    const bool is_mark = steps.front().id.channel == Channel::kReplay;
    const int num_tries = options_.num_tries * (is_mark ? 120 : 1);
    for (int i = 0; i < num_tries; ++i) {
      if (is_mark && options_.say && i % 100 == 99)
        options_.say(what_is_missing() + "; still waiting");
      bus_.publish(Channel::kAck, announcement);
      for (const Step& step : steps) bus_.publish(step.id.channel, step.bytes);
      const std::size_t progress_before = progress_;
      wait_for_answers();
      if (done()) return;
      num_resent_ += static_cast<std::int64_t>(steps.size());
      if (progress_ > progress_before) i = 0;
    }
    throw LockstepError(what_is_missing() +
                        "; gave up after repeated attempts. Restart the processes with --lockstep");
  }

  /// Lets one participant flush.
  void end(std::size_t participant, std::int64_t utime) {
    const ReplayMark mark{utime, 1 + participants_[participant].number, true};
    run({{{Channel::kReplay, mark.seq}, utime, encode(mark)}});
  }

  /// Outputs caused by a step of the round, in order of (channel, seq).
  std::vector<const Output*> outputs_of(std::size_t step) const {
    std::vector<OutputId> ids;
    for (const Participant& p : participants_) {
      ids.insert(ids.end(), p.made[step].begin(), p.made[step].end());
    }
    std::sort(ids.begin(), ids.end());
    std::vector<const Output*> outputs;
    for (const OutputId& id : ids) outputs.push_back(&*outputs_.at(id));
    return outputs;
  }

  std::int64_t num_resent() const { return num_resent_; }

 private:
  std::string missing() const {
    std::string names;
    for (const Participant& p : participants_) {
      if (!p.present) names += (names.empty() ? "" : ", ") + p.name;
    }
    return names;
  }

  /// Returns the bytes that announce the round.
  std::vector<std::uint8_t> start_round(const std::vector<Step>& steps) {
    Ack plan{replay_utime_, ++round_, ack_t::PLAYER, Channel::kReplay, {}};
    for (Participant& p : participants_) {
      plan.outputs.push_back({Channel::kAck, p.number});
      p.made.clear();
      p.answered = false;
    }
    steps_.clear();
    for (const Step& step : steps) steps_.push_back(step.id);
    plan.outputs.insert(plan.outputs.end(), steps_.begin(), steps_.end());
    round_utime_ = steps.front().utime;
    outputs_.clear();
    num_awaited_ = 0;
    return encode(plan);
  }

  /// Waits until the round is done or nothing has come for a while.
  void wait_for_answers() {
    const auto timeout = std::chrono::milliseconds(options_.timeout_ms);
    auto pause = Clock::now() + timeout;
    while (!done() && Clock::now() < pause) {
      if (wait(pause)) pause = Clock::now() + timeout;
    }
  }

  bool is_finished(const Participant& p) const { return p.made.size() == steps_.size(); }

  bool done() const {
    return num_awaited_ == 0 &&
           std::all_of(participants_.begin(), participants_.end(),
                       [this](const Participant& p) { return is_finished(p); });
  }

  std::string what_is_missing() const {
    std::string text = "lockstep replay is stuck at " + text_of(steps_.front()) + " (utime " +
                       std::to_string(round_utime_) + ")";
    for (const Participant& p : participants_) {
      if (is_finished(p)) continue;
      text += p.answered ? "; " + p.name + " waits at " : "; no answer from " + p.name + " to ";
      text += text_of(steps_[p.made.size()]);
    }
    for (const auto& [id, output] : outputs_) {
      if (!output) text += "; " + text_of(id) + " was announced but not received";
    }
    if (!last_refusal_.empty()) text += "; the last refused message was " + last_refusal_;
    return text;
  }

  bool wait(Clock::time_point until) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
    const int timeout_ms = static_cast<int>(std::max<std::int64_t>(left.count(), 0));
    const bool readable = stop_.wait(bus_.fileno(), timeout_ms);
    if (!readable && stop_.raised()) throw Stopped{};
    return readable && bus_.handle(0);
  }

  void on_ack(const Ack& ack) {
    const auto participant =
        std::find_if(participants_.begin(), participants_.end(),
                     [&](const Participant& p) { return p.number == ack.node; });
    if (participant == participants_.end() || ack.utime != replay_utime_) return;
    if (ack.seq == 0) {
      participant->present = true;
      for (const OutputId& input : ack.outputs) participant->inputs.insert(input.channel);
    } else if (ack.seq == round_ && !is_finished(*participant)) {
      accept(*participant, ack);
    }
  }

  /// Records which steps a participant has made. Its outputs follow the ACK of all of them.
  void accept(Participant& participant, const Ack& ack) {
    std::optional<LockstepSteps> made = steps_of(ack, steps_);
    if (!made) return;
    participant.answered = true;
    if (made->size() <= participant.made.size()) return;
    participant.made = std::move(*made);
    ++progress_;
    if (!is_finished(participant)) return;
    for (const auto& step : participant.made) {
      for (const OutputId& id : step) num_awaited_ += outputs_.emplace(id, std::nullopt).second;
    }
  }

  /// Messages that no node announced do not belong to this replay.
  void on_output(const Message& message, Bytes bytes) {
    const auto awaited = outputs_.find({channel_of(message), seq_of(message)});
    if (awaited == outputs_.end()) return;
    const auto& [channel, seq] = awaited->first;
    if (awaited->second) {
      const std::vector<std::uint8_t>& known = awaited->second->bytes;
      if (std::equal(known.begin(), known.end(), bytes.data, bytes.data + bytes.size)) return;
      throw LockstepError("two different messages " + text_of(awaited->first) +
                          " came: another program publishes on " + bus_.url() +
                          ". Stop it, or replay on a network or under a robot's name of its own "
                          "(--lcm-url, --robot)");
    }
    awaited->second =
        Output{channel, seq, utime_of(message), {bytes.data, bytes.data + bytes.size}};
    --num_awaited_;
    ++progress_;
  }

  Bus& bus_;
  StopSignal& stop_;
  const LockstepOptions& options_;
  std::vector<Participant> participants_;
  std::int64_t replay_utime_ = 0;
  std::int32_t round_ = 0;
  std::int64_t round_utime_ = 0;
  std::vector<OutputId> steps_;                        ///< of this round
  std::map<OutputId, std::optional<Output>> outputs_;  ///< announced; none until received
  std::int64_t num_awaited_ = 0;                       ///< of them, not received
  std::size_t progress_ = 0;                           ///< grows with all that was missing
  std::string last_refusal_;
  std::int64_t num_resent_ = 0;
};

}  // namespace

LockstepReport replay_in_lockstep(const std::string& log_path, Bus& bus, StopSignal& stop,
                                  const LockstepOptions& options) {
  LockstepReport report;
  ReplayIndex index = index_log(log_path, options.replay);
  report.replay = std::move(index.report);
  Exchange exchange(bus, stop, options);
  const auto pass_on = [&](std::size_t num_steps) {
    for (std::size_t step = 0; step < num_steps; ++step) {
      for (const Output* output : exchange.outputs_of(step)) {
        ++report.replay.num_out[static_cast<std::size_t>(output->channel)];
        if (options.replay.on_derived) {
          options.replay.on_derived(output->channel, output->utime, output->bytes);
        }
      }
    }
  };
  std::vector<Step> round;
  std::size_t num_bytes = 0;
  std::uint64_t num_done = 0;
  const auto play_round = [&] {
    if (round.empty()) return;
    exchange.run(round);
    for (const Step& step : round) {
      ++report.replay.num_in[static_cast<std::size_t>(step.id.channel)];
    }
    pass_on(round.size());
    round.clear();
    num_bytes = 0;
    if (options.replay.progress) options.replay.progress(num_done, index.entries.size());
  };
  // A message can be as long as a round, and a source that restarts repeats its numbers.
  const auto has_room = [&](const OutputId& id, std::size_t size) {
    return round.size() < kRoundMessages && num_bytes + size <= kRoundBytes &&
           std::none_of(round.begin(), round.end(), [&](const Step& s) { return s.id == id; });
  };
  try {
    exchange.begin(report.replay.first_utime);
    const Clock::time_point start = Clock::now();
    io::LogReader reader(log_path);
    for (const ReplayEntry& entry : index.entries) {
      if (exchange.has_consumers(entry.channel)) {
        std::vector<std::uint8_t> bytes = reader.read_at(entry.offset).data;
        const OutputId id{entry.channel, entry.seq};
        if (!has_room(id, bytes.size())) play_round();
        num_bytes += bytes.size();
        round.push_back({id, timing::utime_of(entry.drive_time), std::move(bytes)});
      }
      ++num_done;
    }
    play_round();
    for (std::size_t i = 0; i < options.nodes.size(); ++i) {
      exchange.end(i, report.replay.last_utime);
      pass_on(1);
    }
    report.elapsed_s = std::chrono::duration<double>(Clock::now() - start).count();
  } catch (const Stopped&) {
    report.stopped = true;
  }
  report.num_resent = exchange.num_resent();
  return report;
}

}  // namespace orchard::bus
