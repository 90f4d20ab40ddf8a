// SPDX-License-Identifier: BSD-3-Clause
// A driver that sends a second of a drive.
#include <deque>

#include "bus/process/process.hpp"
#include "io/config/config.hpp"
#include "node/bus/fake_log.hpp"

namespace {

class Drive : public orchard::bus::Source {
 public:
  Drive() {
    for (auto& message : orchard::bus::testing::fake_drive(10)) messages_.push_back(message);
  }
  std::optional<orchard::bus::Message> next() override {
    if (messages_.empty()) return std::nullopt;
    auto message = messages_.front();
    messages_.pop_front();
    return message;
  }

 private:
  std::deque<orchard::bus::Message> messages_;
};

}  // namespace

int main(int argc, char** argv) {
  orchard::bus::ProcessInfo info;
  info.name = "orchard-fake-driver";
  info.description = "A fake driver for tests.";
  orchard::io::RigFile rig;
  return orchard::bus::run_driver_process(argc, argv, info, rig,
                                          [] { return std::make_unique<Drive>(); });
}
