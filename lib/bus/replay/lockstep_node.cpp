// SPDX-License-Identifier: BSD-3-Clause
#include "bus/replay/lockstep_node.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <set>
#include <utility>

#include "orchard/ack_t.hpp"

namespace orchard::bus {

LockstepNode::LockstepNode(Bus& bus, MakeNode make_node, SaveHook save, const std::string& name,
                           const io::EffectiveConfig& config)
    : bus_(bus),
      report_(bus, name, config),
      make_node_(std::move(make_node)),
      save_(std::move(save)) {
  restart();
  number_ = node_number(node_->name());
  for (const Channel channel : node_->inputs()) {
    bus_.subscribe(channel, [this](Message&& input, Bytes) {
      const OutputId id{channel_of(input), seq_of(input)};
      receive(id, std::move(input));
    });
  }
  bus_.subscribe_ack([this](const Ack& ack) { on_ack(ack); });
  bus_.subscribe_replay([this](const ReplayMark& mark) { on_mark(mark); });
  // Rejected messages are logged but not answered: the player repeats its own and finally reports
  // the node that did not answer. Those of other senders do not matter.
}

void LockstepNode::run(StopSignal& stop) {
  spdlog::info("lockstep: ready for orchard-log-player");
  while (!stop.raised()) {
    if (report_.due()) report_.send(status());
    if (stop.wait(bus_.fileno(), is_ready() ? 0 : report_.ms_until_due())) {
      while (bus_.handle(0) && !stop.raised() && !report_.due()) {
      }
    }
    if (std::exchange(asked_again_, false)) answer();
    if (is_ready()) make_step();
  }
}

Status LockstepNode::status() const {
  Status status;
  status.num_good = host_->num_handled();
  status.num_bad = bus_.counts().num_bad();
  status.num_late = node_->counts().num_late;
  status.num_published = host_->num_published();
  status.text = "in a lockstep replay";
  if (!stranger_.empty()) {
    status.level = Level::kError;
    status.text = stranger_;
    return status;
  }
  if (const std::string warning = warning_text(*node_); !warning.empty()) {
    status.level = Level::kWarning;
    status.text += "; " + warning;
  }
  return status;
}

void LockstepNode::restart() {
  host_.reset();
  node_ = make_node_();
  stranger_.clear();
  host_ = std::make_unique<NodeHost>(*node_, [this](Output&& output) {
    round_.ack.outputs.push_back({output.channel, output.seq});
    round_.outputs.push_back(std::move(output));
  });
  round_ = {};
}

void LockstepNode::on_mark(const ReplayMark& mark) {
  if (mark.end) return receive({Channel::kReplay, mark.seq}, {});
  if (round_.ack.seq > 0) restart();
  replay_utime_ = mark.utime;
  Ack ack{mark.utime, 0, number_, Channel::kReplay, {}};
  for (const Channel channel : node_->inputs()) ack.outputs.push_back({channel, 0});
  bus_.publish(Channel::kAck, encode(ack));
}

void LockstepNode::on_ack(const Ack& ack) {
  if (ack.utime != replay_utime_) return;
  if (ack.node == ack_t::PLAYER) {
    if (ack.seq == round_.ack.seq + 1) return start_round(ack);
    asked_again_ |= ack.seq == round_.ack.seq;
    return;
  }
  const auto sender = round_.senders.find(ack.node);
  if (sender == round_.senders.end() || ack.seq != round_.ack.seq || !sender->second.empty())
    return;
  std::optional<LockstepSteps> made = steps_of(ack, round_.steps);
  if (!made || made->size() < round_.steps.size()) return;
  for (const auto& step : *made) {
    for (const OutputId& id : step) expect(id);
  }
  sender->second = std::move(*made);
}

void LockstepNode::start_round(const Ack& plan) {
  round_ = {};
  round_.ack = {plan.utime, plan.seq, number_, Channel::kReplay, {}};
  std::set<std::int8_t> participants;
  for (const OutputId& id : plan.outputs) {
    if (id.channel == Channel::kAck) {
      participants.insert(static_cast<std::int8_t>(id.seq));
    } else {
      round_.steps.push_back(id);
      expect(id);
    }
  }
  for (const Channel channel : node_->inputs()) {
    if (info(channel).role != Role::kDerived) continue;
    if (participants.count(sender_of(channel)) > 0) round_.senders[sender_of(channel)];
  }
}

bool LockstepNode::reads(const OutputId& id) const {
  if (id.channel == Channel::kReplay) return id.seq == 1 + number_;  // else another node flushes
  const std::vector<Channel> inputs = node_->inputs();
  return std::find(inputs.begin(), inputs.end(), id.channel) != inputs.end();
}

void LockstepNode::expect(const OutputId& id) {
  if (reads(id)) round_.inputs.emplace(id, std::nullopt);
}

/// Messages that nobody announced do not belong to this round. Two that differ under one number:
/// one of them is a stranger's, and may have been handled.
void LockstepNode::receive(const OutputId& id, Message&& message) {
  const auto expected = round_.inputs.find(id);
  if (expected == round_.inputs.end()) return;
  const std::int64_t utime = utime_of(message);
  const auto [known, is_first] = round_.utimes.emplace(id, utime);
  if (is_first) {
    expected->second = std::move(message);
  } else if (known->second != utime && stranger_.empty()) {
    stranger_ = "another program publishes " + std::string(info(id.channel).name) +
                " into the lockstep replay on " + bus_.url() + "; replay on another network";
    spdlog::error("lockstep: {}", stranger_);
  }
}

/// The order of a bus that is drained after each source message: that message, then what it made
/// the other nodes send.
std::vector<OutputId> LockstepNode::inputs_of(std::size_t step) const {
  std::vector<OutputId> inputs;
  const auto add = [&](const OutputId& id) {
    if (round_.inputs.count(id) > 0) inputs.push_back(id);
  };
  add(round_.steps[step]);
  for (const auto& [node, made] : round_.senders) {
    for (const OutputId& id : made[step]) add(id);
  }
  return inputs;
}

bool LockstepNode::is_ready() const {
  if (round_.num_made == round_.steps.size()) return false;
  for (const auto& [node, made] : round_.senders) {
    if (made.empty()) return false;
  }
  const std::vector<OutputId> inputs = inputs_of(round_.num_made);
  return std::all_of(inputs.begin(), inputs.end(),
                     [this](const OutputId& id) { return round_.inputs.at(id).has_value(); });
}

void LockstepNode::make_step() {
  round_.ack.outputs.push_back(round_.steps[round_.num_made]);
  for (const OutputId& id : inputs_of(round_.num_made)) {
    if (id.channel == Channel::kReplay) {
      finish();
    } else {
      host_->deliver_as_sent(std::move(*round_.inputs.at(id)));
    }
  }
  if (++round_.num_made == round_.steps.size()) answer();
}

void LockstepNode::finish() {
  host_->flush();
  const Writing write = save_ ? save_(*node_, {SaveKind::kFinal, host_->traffic()}) : Writing();
  if (write) write();
  spdlog::info("lockstep: end of the log after {} inputs", host_->num_handled());
}

/// The ACK goes first, because who receives an output takes only what was announced.
void LockstepNode::answer() {
  if (!stranger_.empty()) return;
  bus_.publish(Channel::kAck, encode(round_.ack));
  if (round_.num_made < round_.steps.size()) return;
  for (const Output& output : round_.outputs) bus_.publish(output.channel, output.bytes);
}

}  // namespace orchard::bus
