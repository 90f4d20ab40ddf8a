// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/field_drive.hpp"

#include <cstdio>
#include <fstream>
#include <map>
#include <variant>

#include "bus/messages/codec.hpp"
#include "io/log/log_writer.hpp"
#include "simulation/simulator.hpp"

namespace orchard::bench {

FieldDrive simulate_field_drive(const std::string& folder, double duration_s, double fix_rate_hz,
                                bool fixes_only) {
  FieldDrive drive;
  drive.config = io::load_config(ORCHARD_SOURCE_DIR "/config/orchard.yaml");
  simulation::SimulationConfig& simulation = drive.config.simulation;
  simulation.motion.gnss_rate_hz = 0.0;
  simulation.orchard.fix_rate_hz = fix_rate_hz;
  if (fixes_only) {
    drive.config.pose.mode = pose::PoseMode::kFixes;
    simulation.image.offset_s = 0.0;
  }
  drive.config_path = folder + "/rig.yaml";
  std::ofstream(drive.config_path) << io::print_config(drive.config);

  const simulation::RigConfig rig{drive.config.laser, drive.config.camera, simulation, {}};
  simulation::Simulator simulator(simulation::SceneKind::kOrchard, 1, rig);
  drive.log_path = folder + "/drive.lcm";
  io::LogWriter writer(drive.log_path);
  while (const auto sensed = simulator.next()) {
    const bus::Message message = std::visit([](const auto& m) { return bus::Message(m); }, *sensed);
    const std::int64_t utime = bus::utime_of(message);
    const double time_s = 1e-6 * static_cast<double>(utime - simulation::kEpochUtime);
    if (time_s > duration_s) break;
    drive.duration_s = time_s;
    drive.messages.push_back({utime, bus::channel_of(message), bus::encode(message)});
    writer.write(utime, bus::info(bus::channel_of(message)).name, drive.messages.back().bytes);
  }
  writer.close();
  return drive;
}

void describe_drive(const FieldDrive& drive) {
  std::map<bus::Channel, std::pair<int, std::size_t>> counts;
  for (const RawMessage& message : drive.messages) {
    ++counts[message.channel].first;
    counts[message.channel].second += message.bytes.size();
  }
  std::printf("a drive of %.1f s through the simulated orchard:", drive.duration_s);
  for (const auto& [channel, count] : counts) {
    std::printf(" %d %s of %zu bytes;", count.first, std::string(bus::info(channel).name).c_str(),
                count.second / static_cast<std::size_t>(count.first));
  }
  std::printf("\n");
  std::fflush(stdout);
}

}  // namespace orchard::bench
