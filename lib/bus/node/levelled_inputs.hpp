// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "bus/messages/channel.hpp"
#include "bus/messages/message.hpp"
#include "io/config/config.hpp"
#include "pose/attitude/leveller.hpp"

namespace orchard::bus {

/// The inputs of a node that reads scans, made horizontal where the rig states the height of its
/// scanner (laser.height_m); else as they come. SCAN, SCAN.rear, ODOMETRY and IMU wait for the IMU
/// of their time and come in order of time, others pass at once.
class LevelledInputs {
 public:
  explicit LevelledInputs(const io::Config& config);

  /// Whether the rig has wheels that the detector or orchard-pose uses.
  bool has_wheels() const { return has_wheels_; }

  bool is_active() const { return leveller_.has_value(); }

  /// Adds the channels that levelling reads.
  void add_channels(std::vector<Channel>& channels) const;

  /// Whether a node reads a channel for levelling.
  bool reads(Channel channel) const;

  /// Calls use(message) for every input that is ready after `input`.
  template <class Use>
  void pass(const Message& input, Use&& use) {
    if (!leveller_ || !take(input)) return use(input);
    while (auto next = leveller_->take()) use(message(*std::move(next)));
  }

  /// The same at the end of the inputs, for those that still wait.
  template <class Use>
  void flush(Use&& use) {
    if (!leveller_) return;
    while (auto next = leveller_->take_flushed()) use(message(*std::move(next)));
  }

  /// The tilt at a time near the newest IMU that was passed on; none where nothing is levelled.
  std::optional<pose::Attitude> tilt_at(std::int64_t utime) const {
    return leveller_ ? leveller_->tilt_at(utime) : std::nullopt;
  }

  std::string warning() const { return leveller_ ? leveller_->warning() : std::string{}; }

 private:
  bool take(const Message& input);
  static Message message(pose::Leveller::Input input);

  bool has_wheels_;
  std::optional<pose::Leveller> leveller_;
};

}  // namespace orchard::bus
