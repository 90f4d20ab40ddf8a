// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "bus/messages/message.hpp"

namespace orchard::bus {

struct Status;

/// Where a node's outputs go, in the order in which it sends them.
using Outbox = std::function<void(Message)>;

/// Inputs a node had to set aside, and why; the host reports them in STATUS and summary.json.
struct NodeCounts {
  std::int64_t num_late = 0;      ///< came after what they belong to was decided
  std::int64_t num_unusable = 0;  ///< well-formed, but of no use (a picture that does not decode)
};

/// What it means for a node that an input does not come.
enum class InputNeed {
  kRequired,    ///< it can do nothing: it waits
  kOptional,    ///< it works without; that one that came falls silent is said
  kOccasional,  ///< it comes now and then, or never
};

/// What follows from an input alone, or from inputs that do not wait for other nodes: computed
/// ahead of its turn by any thread.
class Foreseen {
 public:
  virtual ~Foreseen() = default;
  virtual void compute() = 0;
};

/// One role of the system (detector, pose, mapper): a pure function of its configuration and the
/// sequence of its inputs. The same object runs in the live process, in the players and in tests.
class Node {
 public:
  virtual ~Node() = default;

  /// Short name: "detector", "pose", "mapper".
  virtual std::string_view name() const = 0;
  virtual std::vector<Channel> inputs() const = 0;

  /// What an input is for, of inputs().
  virtual InputNeed need_of(Channel channel) const {
    const bool occasional = channel == Channel::kTrajectory || channel == Channel::kPoseFix ||
                            channel == Channel::kAdaptation;
    return occasional ? InputNeed::kOccasional : InputNeed::kRequired;
  }

  /// Takes one input and sends what follows from it. Inputs of one channel come with rising seq
  /// (the host drops duplicates); between channels any order may occur and must not matter.
  virtual void handle(const Message& input, const Outbox& send) = 0;

  /// A replay on several cores: what of handle(input) can be computed before its turn; none where
  /// nothing can. Called for each input in order, by one thread at a time, but while another may be
  /// in handle() of an earlier one. `input` outlives what is given.
  virtual std::unique_ptr<Foreseen> foresee(const Message& /*input*/) { return nullptr; }

  /// What foresee() gave of the input that handle() gets next, computed. What handle() sends does
  /// not depend on it.
  virtual void expect(std::unique_ptr<Foreseen> /*foreseen*/) {}

  /// Live only: how a process said it is. For who shows that to people; no output may depend on it.
  virtual void overhear(const Status& /*status*/) {}

  /// No input will follow: sends what was still waiting for one.
  virtual void flush(const Outbox& send) = 0;

  virtual NodeCounts counts() const { return {}; }

  /// What it waits for, in words for a person ("SCAN at 12.3 s waits for an IMAGE"); empty if
  /// nothing.
  virtual std::string waiting_for() const { return {}; }

  /// What is wrong with what it is given, in words for a person (a camera that is turned); empty if
  /// nothing. Shown in STATUS with level WARNING. After flush(): what was wrong at any time.
  virtual std::string warning() const { return {}; }
};

}  // namespace orchard::bus
