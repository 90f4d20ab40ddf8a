// SPDX-License-Identifier: BSD-3-Clause
// fake_player LOG URL OUT: lockstep replay of a log that it makes itself, TENTHS long.
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "bus/replay/lockstep.hpp"
#include "io/log/log_writer.hpp"
#include "node/bus/fake_log.hpp"
#include "node/bus/fake_nodes.hpp"

using namespace orchard;

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  const std::string log = argv[1];
  const std::string url = argv[2];
  try {
    bus::testing::write_log(log, bus::testing::fake_drive(std::atoi(argv[4])));
    io::LogWriter out(argv[3]);
    bus::ReplayOptions replay;
    replay.on_derived = [&out](bus::Channel channel, std::int64_t utime, const auto& bytes) {
      out.write(utime, bus::info(channel).name, bytes);
    };
    if (url == "in-process") {
      bus::testing::FakeDetector detector;
      bus::testing::FakePose pose;
      bus::testing::FakeMapper mapper;
      bus::replay_in_process(log, {&detector, &pose, &mapper}, replay);
    } else {
      bus::StopSignal stop;
      bus::Bus bus(bus::lockstep_url(url));
      bus::LockstepOptions options;
      options.replay = replay;
      options.timeout_ms = 50;
      options.num_tries = 20;
      options.start_timeout_s = 20;
      const bus::LockstepReport report = bus::replay_in_lockstep(log, bus, stop, options);
      std::printf("resent %lld elapsed %.3f\n", static_cast<long long>(report.num_resent),
                  report.elapsed_s);
    }
    out.close();
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fake_player: %s\n", error.what());
    return 1;
  }
}
