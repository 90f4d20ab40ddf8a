// SPDX-License-Identifier: BSD-3-Clause
#include "bus/replay/lockstep_node.hpp"

#include <spdlog/spdlog.h>

#include <stdexcept>
#include <string>

#include "orchard/ack_t.hpp"

namespace orchard::bus {
namespace {

/// Replies kept per channel: more than one input can cause before the player waits for answers.
constexpr std::size_t kNumRemembered = 4096;

}  // namespace

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
  if (const std::string warning = node_->warning(); !warning.empty()) {
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
      if (save_) save_(*node_, {SaveKind::kFinal, host_->traffic()});
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
    host_->deliver(input);
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

}  // namespace orchard::bus
