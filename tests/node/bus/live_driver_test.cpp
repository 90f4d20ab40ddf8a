// SPDX-License-Identifier: BSD-3-Clause
#include "bus/driver/live_driver.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

namespace orchard::bus {
namespace {

/// Ends after some steps, one a millisecond.
class Ending : public Driver {
 public:
  explicit Ending(int num_steps) : num_left_(num_steps) {}
  std::vector<pollfd> files() override { return {}; }
  Clock::time_point deadline() override { return Clock::now() + std::chrono::milliseconds(1); }
  void step(const Outbox&) override { --num_left_; }
  bool ended() const override { return num_left_ <= 0; }

 private:
  int num_left_;
};

/// The last STATUS of a driver that hears another process's.
Status status_beside(const std::string& name, std::int64_t ahead_us) {
  StopSignal stop;
  Bus bus("memq://");
  Ending driver(20);
  ProcessOptions options;
  LiveDriver live(bus, driver, "orchard-toy-driver", options);
  Status last;
  bus.subscribe_status([&](const Status& heard) {
    if (heard.host != "elsewhere:7") last = heard;
  });
  for (int k = 0; k < 4; ++k) {
    Status other;
    other.utime = wall_utime() + ahead_us;
    other.seq = k;
    other.name = name;
    other.host = "elsewhere:7";
    bus.publish(Channel::kStatus, encode(other));
  }
  live.run(stop);
  while (bus.handle(0)) {
  }
  return last;
}

TEST(LiveDriver, NamesASecondOneAndAnotherClock) {
  const Status duplicate = status_beside("orchard-toy-driver", 0);
  EXPECT_EQ(duplicate.level, Level::kError);
  EXPECT_NE(duplicate.text.find("orchard-toy-driver on elsewhere:7 runs beside"), std::string::npos)
      << duplicate.text;
  const Status skewed = status_beside("orchard-pose", 200'000'000);
  EXPECT_EQ(skewed.level, Level::kWarning);
  EXPECT_NE(skewed.text.find("the clock of elsewhere is"), std::string::npos) << skewed.text;
  const Status alone = status_beside("orchard-pose", 0);
  EXPECT_EQ(alone.level, Level::kOk);
  EXPECT_EQ(alone.text, "the source has ended");
}

}  // namespace
}  // namespace orchard::bus
