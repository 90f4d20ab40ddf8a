// SPDX-License-Identifier: BSD-3-Clause
#include "bus/replay/lockstep.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "bus/node/node.hpp"
#include "bus/replay/replay_index.hpp"
#include "orchard/ack_t.hpp"

namespace orchard::bus {
namespace {

constexpr int kPortsApart = 10'000;
constexpr int kPortMax = 65'535;

/// LCM's defaults for a URL without address or port.
constexpr std::string_view kDefaultAddress = "239.255.76.67";
constexpr int kDefaultPort = 7667;

/// Replies kept per channel: more than one input can cause before the player waits for answers.
constexpr std::size_t kNumRemembered = 4096;

using Clock = std::chrono::steady_clock;

struct Stopped {};

/// Max number of outputs kept for one input, so that other senders cannot fill the memory.
constexpr std::size_t kOutputsMax = 100'000;

/// Identifies a message in acknowledgements. For REPLAY, seq distinguishes BEGIN and END.
struct MessageId {
  Channel channel = Channel::kScan;
  std::int32_t seq = 0;
  bool operator<(const MessageId& other) const {
    return std::tie(channel, seq) < std::tie(other.channel, other.seq);
  }
};

/// A message as an acknowledgement names it.
struct MessageName {
  MessageId id;
  std::int64_t utime = 0;
  bool operator<(const MessageName& other) const {
    return std::tie(id, utime) < std::tie(other.id, other.utime);
  }
};

/// The latest messages of a replay: a late acknowledgement may still name one of them.
class RecentMessages {
 public:
  void add(const MessageName& name) {
    if (!names_.insert(name).second) return;
    order_.push_back(name);
    if (order_.size() <= kNumRemembered) return;
    names_.erase(order_.front());
    order_.pop_front();
  }
  bool has(const MessageName& name) const { return names_.count(name) > 0; }

 private:
  std::set<MessageName> names_;
  std::deque<MessageName> order_;
};

struct Participant {
  std::string name;
  std::int8_t number = 0;
  bool present = false;
  std::set<Channel> inputs;
};

/// The player's side of the protocol: one source message at a time and everything derived from it.
class Exchange {
 public:
  Exchange(Bus& bus, StopSignal& stop, const LockstepOptions& options)
      : bus_(bus), stop_(stop), options_(options) {
    for (const std::string& name : options.nodes) {
      participants_.push_back({name, node_number(name), false, {}});
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
    root_ = {Channel::kReplay, 0};
    root_utime_ = utime;
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

  void play(const ReplayEntry& entry, const std::vector<std::uint8_t>& bytes) {
    std::set<std::int8_t> expected;
    for (const Participant& p : participants_) {
      if (p.inputs.count(entry.channel) > 0) expected.insert(p.number);
    }
    run({entry.channel, entry.seq}, timing::utime_of(entry.drive_time), std::move(expected), bytes);
  }

  /// Lets one participant flush.
  void end(std::size_t participant, std::int64_t utime) {
    const std::int8_t number = participants_[participant].number;
    const ReplayMark mark{utime, 1 + number, true};
    run({Channel::kReplay, mark.seq}, utime, {number}, encode(mark));
  }

  /// Ends the step after its outputs were passed on; repeated ones are then recognized as old.
  void close_step() {
    recent_.add({root_, root_utime_});
    for (const auto& [id, output] : outputs_) {
      recent_.add({id, output.utime});
      std::int32_t& last = past_.emplace(id.channel, -1).first->second;
      last = std::max(last, id.seq);
    }
  }

  /// Outputs caused by the last message, in order of (channel, seq).
  const std::map<MessageId, Output>& outputs() const { return outputs_; }
  std::int64_t num_resent() const { return num_resent_; }

 private:
  std::string missing() const {
    std::string names;
    for (const Participant& p : participants_) {
      if (!p.present) names += (names.empty() ? "orchard-" : ", orchard-") + p.name;
    }
    return names;
  }

  /// Sends one message, repeatedly if needed, until everything derived from it has been
  /// acknowledged and received.
  void run(MessageId id, std::int64_t utime, std::set<std::int8_t> expected,
           const std::vector<std::uint8_t>& bytes) {
    root_ = id;
    root_utime_ = utime;
    waiting_.clear();
    acknowledged_.clear();
    announced_.clear();
    promised_.clear();
    outputs_.clear();
    taken_.clear();
    if (!expected.empty()) waiting_[id] = std::move(expected);
    // A flush may save the map of a whole day on a busy machine.
    const bool is_mark = id.channel == Channel::kReplay;
    const int num_tries = options_.num_tries * (is_mark ? 120 : 1);
    for (int i = 0; i < num_tries; ++i) {
      if (i > 0) ++num_resent_;
      if (is_mark && options_.say && i % 100 == 99)
        options_.say(what_is_missing() + "; still waiting");
      bus_.publish(id.channel, bytes);
      auto pause = Clock::now() + std::chrono::milliseconds(options_.timeout_ms);
      while (!done() && Clock::now() < pause) {
        // Do not repeat the message while its chain of outputs still makes progress.
        if (wait(pause)) pause = Clock::now() + std::chrono::milliseconds(options_.timeout_ms);
      }
      if (done()) return end_step();
    }
    throw LockstepError(what_is_missing() +
                        "; gave up after repeated attempts. Restart the processes with --lockstep");
  }

  /// Drops outputs that no node announced: they do not belong to this replay. What a node took of
  /// them has changed its results.
  void end_step() {
    for (const auto& [name, node] : taken_) {
      const auto output = outputs_.find(name.id);
      const bool is_own = promised_.count(name.id) > 0 && output != outputs_.end() &&
                          output->second.utime == name.utime;
      if (!is_own) refuse_stranger(name, node);
    }
    for (auto output = outputs_.begin(); output != outputs_.end();) {
      output = promised_.count(output->first) > 0 ? std::next(output) : outputs_.erase(output);
    }
  }

  [[noreturn]] void refuse_stranger(const MessageName& name, std::int8_t node) const {
    throw LockstepError(
        name_of(node) + " took " + std::string(info(name.id.channel).name) + " seq " +
        std::to_string(name.id.seq) + " (utime " + std::to_string(name.utime) +
        "), which does not belong to this replay: another program publishes on " + bus_.url() +
        ". Stop it, or replay on a network or under a robot's name of its own "
        "(--lcm-url, --robot)");
  }

  bool is_past(const MessageId& id) const {
    const auto last = past_.find(id.channel);
    return last != past_.end() && id.seq <= last->second;
  }

  bool done() const { return waiting_.empty() && announced_.empty(); }

  std::string what_is_missing() const {
    std::string text = "lockstep replay is stuck at " + std::string(info(root_.channel).name) +
                       " seq " + std::to_string(root_.seq) + " (utime " +
                       std::to_string(root_utime_) + ")";
    for (const auto& [id, nodes] : waiting_) {
      for (const std::int8_t number : nodes) {
        text += "; no answer from " + name_of(number) + " to " +
                std::string(info(id.channel).name) + " seq " + std::to_string(id.seq);
      }
    }
    for (const MessageId& id : announced_) {
      text += "; " + std::string(info(id.channel).name) + " seq " + std::to_string(id.seq) +
              " was announced but not received";
    }
    if (!last_refusal_.empty()) text += "; the last refused message was " + last_refusal_;
    return text;
  }

  std::string name_of(std::int8_t number) const {
    for (const Participant& p : participants_) {
      if (p.number == number) return "orchard-" + p.name;
    }
    return "node " + std::to_string(number);
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
    if (participant == participants_.end()) return;
    if (ack.channel == Channel::kReplay && ack.seq == 0) {
      if (ack.utime != root_utime_) return;
      participant->present = true;
      for (const OutputId& input : ack.outputs) participant->inputs.insert(input.channel);
      return;
    }
    if (!participant->present) return;  // of the replay before
    const MessageId id{ack.channel, ack.seq};
    const MessageName name{id, ack.utime};
    if (recent_.has(name)) return;  // repeated
    const auto open = waiting_.find(id);
    const bool is_root = info(ack.channel).role != Role::kDerived;
    if (is_root && (ack.utime != root_utime_ || ack.seq != root_.seq)) {
      refuse_stranger(name, ack.node);
    }
    if (!is_root) taken_.emplace_back(name, ack.node);
    if (open == waiting_.end() || open->second.erase(ack.node) == 0) {
      // A consumer may acknowledge an output before the ACK that announces the output arrives.
      if (!is_root && !is_past(id) && acknowledged_.count({id, ack.node}) == 0) accept(id, ack);
      return;
    }
    if (open->second.empty()) waiting_.erase(open);
    accept(id, ack);
  }

  /// Records an acknowledgement and the outputs that it announces.
  void accept(const MessageId& id, const Ack& ack) {
    acknowledged_.insert({id, ack.node});
    for (const OutputId& output : ack.outputs) {
      const MessageId output_id{output.channel, output.seq};
      promised_.insert(output_id);
      if (outputs_.count(output_id) == 0) announced_.insert(output_id);
      for (const Participant& p : participants_) {
        if (p.inputs.count(output.channel) > 0 && acknowledged_.count({output_id, p.number}) == 0) {
          waiting_[output_id].insert(p.number);
        }
      }
    }
  }

  void on_output(const Message& message, Bytes bytes) {
    const MessageId id{channel_of(message), seq_of(message)};
    announced_.erase(id);
    if (is_past(id)) return;                     // repeated
    if (outputs_.size() >= kOutputsMax) return;  // no input causes so many
    Output output{id.channel, id.seq, utime_of(message), {bytes.data, bytes.data + bytes.size}};
    const auto known = outputs_.emplace(id, output).first;
    if (known->second.bytes == output.bytes) return;
    throw LockstepError("two different messages " + std::string(info(id.channel).name) + " seq " +
                        std::to_string(id.seq) + " came: another program publishes on " +
                        bus_.url() +
                        ". Stop it, or replay on a network or under a robot's name of its own "
                        "(--lcm-url, --robot)");
  }

  Bus& bus_;
  StopSignal& stop_;
  const LockstepOptions& options_;
  std::vector<Participant> participants_;
  MessageId root_;
  std::int64_t root_utime_ = 0;
  std::map<MessageId, std::set<std::int8_t>> waiting_;
  std::set<std::pair<MessageId, std::int8_t>> acknowledged_;
  std::set<MessageId> announced_;
  std::set<MessageId> promised_;  ///< outputs announced by the acknowledgements of this step
  std::map<MessageId, Output> outputs_;
  std::string last_refusal_;
  std::vector<std::pair<MessageName, std::int8_t>> taken_;  ///< derived, of this step, by node
  RecentMessages recent_;
  std::map<Channel, std::int32_t> past_;  ///< highest seq passed on
  std::int64_t num_resent_ = 0;
};

}  // namespace

std::string lockstep_url(const std::string& lcm_url) {
  constexpr std::string_view kScheme = "udpm://";
  if (lcm_url.compare(0, kScheme.size(), kScheme) != 0) return lcm_url;
  const std::size_t end = std::min(lcm_url.find('?'), lcm_url.size());
  const std::string network = lcm_url.substr(kScheme.size(), end - kScheme.size());
  const std::size_t colon = std::min(network.find(':'), network.size());
  std::string address = network.substr(0, colon);
  if (address.empty()) address = kDefaultAddress;
  int port = kDefaultPort;
  if (colon < network.size()) {
    const char* text = network.data() + colon + 1;
    const auto read = std::from_chars(text, network.data() + network.size(), port);
    if (read.ec != std::errc()) return lcm_url;  // LCM reports the error
  }
  port += port + kPortsApart <= kPortMax ? kPortsApart : -kPortsApart;
  return std::string(kScheme) + address + ":" + std::to_string(port) + lcm_url.substr(end);
}

std::int8_t node_number(std::string_view name) {
  if (name == "detector") return ack_t::DETECTOR;
  if (name == "pose") return ack_t::POSE;
  if (name == "mapper") return ack_t::MAPPER;
  throw std::invalid_argument("lockstep knows the nodes detector, pose and mapper, not \"" +
                              std::string(name) + "\"");
}

LockstepNode::LockstepNode(Bus& bus, MakeNode make_node, SaveHook save, const std::string& name,
                           const io::EffectiveConfig& config)
    : bus_(bus),
      report_(bus, name, config),
      make_node_(std::move(make_node)),
      save_(std::move(save)) {
  restart();
  number_ = node_number(node_->name());
  for (const Channel channel : node_->inputs()) {
    bus_.subscribe(channel, [this](const Message& input, Bytes) { on_input(input); });
  }
  bus_.subscribe_replay([this](const ReplayMark& mark) { on_mark(mark); });
  // Rejected messages are logged but not answered: the player repeats its own and finally reports
  // the node that did not answer. Those of other senders do not matter.
}

void LockstepNode::run(StopSignal& stop) {
  spdlog::info("lockstep: ready for orchard-log-player");
  while (!stop.raised()) {
    if (report_.due()) report_.send(status());
    if (!stop.wait(bus_.fileno(), report_.ms_until_due())) continue;
    while (bus_.handle(0) && !stop.raised() && !report_.due()) {
    }
  }
}

Status LockstepNode::status() const {
  Status status;
  status.num_good = host_->num_handled();
  status.num_bad = bus_.counts().num_bad();
  status.num_late = node_->counts().num_late;
  status.num_published = host_->num_published();
  status.text = "in a lockstep replay";
  if (const std::string warning = warning_text(*node_); !warning.empty()) {
    status.level = Level::kWarning;
    status.text += "; " + warning;
  }
  return status;
}

void LockstepNode::restart() {
  host_.reset();
  node_ = make_node_();
  host_ = std::make_unique<NodeHost>(
      *node_, [this](Output&& output) { outputs_.push_back(std::move(output)); });
  fresh_ = true;
  answered_ = {};
  last_seq_.fill(-1);
}

void LockstepNode::on_mark(const ReplayMark& mark) {
  if (mark.end) {
    if (mark.seq != 1 + number_) return;  // another node flushes
    fresh_ = false;
    answer(Channel::kReplay, {mark.utime, mark.seq}, [this] {
      host_->flush();
      const Writing write = save_ ? save_(*node_, {SaveKind::kFinal, host_->traffic()}) : Writing();
      if (write) write();
      spdlog::info("lockstep: end of the log after {} inputs", host_->num_handled());
    });
    return;
  }
  if (!fresh_) restart();
  Ack ack{mark.utime, mark.seq, number_, Channel::kReplay, {}};
  for (const Channel channel : node_->inputs()) ack.outputs.push_back({channel, 0});
  bus_.publish(Channel::kAck, encode(ack));
}

void LockstepNode::on_input(const Message& input) {
  const Channel channel = channel_of(input);
  const Key key{utime_of(input), seq_of(input)};
  if (comes_too_early(channel, key.second)) return;
  fresh_ = false;
  answer(channel, key, [&] {
    last_seq_[static_cast<std::size_t>(channel)] = key.second;
    host_->deliver_as_sent(input);
  });
}

/// A derived message whose predecessor was lost is not answered; the player then repeats both in
/// order.
bool LockstepNode::comes_too_early(Channel channel, std::int32_t seq) const {
  return info(channel).role == Role::kDerived &&
         seq > last_seq_[static_cast<std::size_t>(channel)] + 1;
}

void LockstepNode::answer(Channel channel, Key key, const std::function<void()>& consume) {
  Answered& answered = answered_[static_cast<std::size_t>(channel)];
  const auto known = answered.replies.find(key);
  if (known != answered.replies.end()) {
    send(known->second);
    return;
  }
  outputs_.clear();
  consume();
  Reply reply;
  reply.ack = {key.first, key.second, number_, channel, {}};
  for (const Output& output : outputs_) reply.ack.outputs.push_back({output.channel, output.seq});
  reply.outputs = std::move(outputs_);
  send(reply);
  answered.replies.emplace(key, std::move(reply));
  answered.order.push_back(key);
  if (answered.order.size() > kNumRemembered) {
    answered.replies.erase(answered.order.front());
    answered.order.pop_front();
  }
}

void LockstepNode::send(const Reply& reply) {
  for (const Output& output : reply.outputs) bus_.publish(output.channel, output.bytes);
  bus_.publish(Channel::kAck, encode(reply.ack));
}

LockstepReport replay_in_lockstep(const std::string& log_path, Bus& bus, StopSignal& stop,
                                  const LockstepOptions& options) {
  LockstepReport report;
  ReplayIndex index = index_log(log_path, options.replay);
  report.replay = std::move(index.report);
  Exchange exchange(bus, stop, options);
  const auto pass_on = [&] {
    for (const auto& [id, output] : exchange.outputs()) {
      ++report.replay.num_out[static_cast<std::size_t>(id.channel)];
      if (options.replay.on_derived) {
        options.replay.on_derived(id.channel, output.utime, output.bytes);
      }
    }
    exchange.close_step();
  };
  try {
    exchange.begin(report.replay.first_utime);
    const Clock::time_point start = Clock::now();
    io::LogReader reader(log_path);
    std::uint64_t num_done = 0;
    for (const ReplayEntry& entry : index.entries) {
      ++num_done;
      if (!exchange.has_consumers(entry.channel)) continue;
      exchange.play(entry, reader.read_at(entry.offset).data);
      ++report.replay.num_in[static_cast<std::size_t>(entry.channel)];
      pass_on();
      if (options.replay.progress) options.replay.progress(num_done, index.entries.size());
    }
    for (std::size_t i = 0; i < options.nodes.size(); ++i) {
      exchange.end(i, report.replay.last_utime);
      pass_on();
    }
    report.elapsed_s = std::chrono::duration<double>(Clock::now() - start).count();
  } catch (const Stopped&) {
    report.stopped = true;
  }
  report.num_resent = exchange.num_resent();
  return report;
}

}  // namespace orchard::bus
