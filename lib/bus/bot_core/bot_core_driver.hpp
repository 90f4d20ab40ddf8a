// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bus/bot_core/bot_core_translator.hpp"
#include "bus/driver/driver.hpp"

namespace orchard::bus {

/// Uses a robot that publishes libbot's LCM types as a sensor: listens to all channels of its
/// network and sends the translated messages.
class BotCoreDriver : public Driver {
 public:
  /// Throws BusError when the network cannot be used.
  BotCoreDriver(const device::BotCoreConfig& config, std::size_t max_image_bytes);
  ~BotCoreDriver() override;

  std::vector<pollfd> files() override;
  Clock::time_point deadline() override;
  void step(const Outbox& send) override;
  DriverCondition condition() const override;

 private:
  struct Inbox;
  std::unique_ptr<Inbox> inbox_;
  BotCoreTranslator translator_;
  std::string lcm_url_;
  Clock::time_point heard_;
  bool has_heard_ = false;
};

}  // namespace orchard::bus
