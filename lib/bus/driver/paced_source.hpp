// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "bus/driver/driver.hpp"
#include "bus/driver/source.hpp"

namespace orchard::bus {

/// Plays a source as a driver: sends each message at its time, relative to the first one.
class PacedSource : public Driver {
 public:
  /// `speed`: factor of real time, above 0.
  PacedSource(Source& source, double speed) : source_(source), speed_(speed) {}

  std::vector<pollfd> files() override { return {}; }
  Clock::time_point deadline() override;
  void step(const Outbox& send) override;
  bool ended() const override { return begun_ && !next_; }
  std::optional<double> duration_s() const override { return source_.duration_s(); }

 private:
  void begin();

  Source& source_;
  double speed_;
  bool begun_ = false;
  std::optional<Message> next_;
  Clock::time_point start_;
  std::int64_t first_utime_ = 0;
};

}  // namespace orchard::bus
