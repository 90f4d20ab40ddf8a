// SPDX-License-Identifier: BSD-3-Clause
// What fraction of one core detector, pose and mapper need together while a robot drives: user and
// system time of the real processes, fed over multicast at field rate.
#include <chrono>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include "benchmark/bench_support.hpp"
#include "benchmark/result_line.hpp"
#include "bus/bus.hpp"

namespace {

using namespace orchard;
using Clock = std::chrono::steady_clock;

constexpr double kDriveS = 26.0;
constexpr double kWarmUpS = 2.0;  ///< start of the processes and of the first messages
constexpr double kTarget = 0.05;

}  // namespace

int main() {
  const std::string problem = bench::enter_private_network();
  if (!problem.empty()) {
    std::printf("bench_cpu: %s\n", problem.c_str());
    return 1;
  }
  const bench::TemporaryFolder folder;
  const bench::FieldDrive drive =
      bench::simulate_field_drive(folder.path(""), kDriveS, 10.0, false);
  bench::describe_drive(drive);
  bus::Bus bus(drive.config.lcm.url);
  std::vector<bench::ChildProcess> processes =
      bench::start_live_pipeline(drive.config_path, bus.url(), folder);

  std::vector<double> before_s(processes.size());
  bool warm = false;
  const Clock::time_point start = Clock::now();
  Clock::time_point measured_from = start;
  const std::int64_t first_utime = drive.messages.front().utime;
  for (const bench::RawMessage& message : drive.messages) {
    const auto since_first = std::chrono::microseconds(message.utime - first_utime);
    std::this_thread::sleep_until(start + since_first);
    bus.publish(message.channel, message.bytes);
    if (!warm && std::chrono::duration<double>(since_first).count() >= kWarmUpS) {
      warm = true;
      measured_from = Clock::now();
      for (std::size_t i = 0; i < processes.size(); ++i) before_s[i] = processes[i].cpu_s();
    }
  }
  const double elapsed_s = std::chrono::duration<double>(Clock::now() - measured_from).count();
  double total = 0.0;
  std::string parts;
  for (std::size_t i = 0; i < processes.size(); ++i) {
    const double fraction = (processes[i].cpu_s() - before_s[i]) / elapsed_s;
    total += fraction;
    char text[80];
    std::snprintf(text, sizeof text, "%s%s %.1f %%", parts.empty() ? "" : ", ",
                  processes[i].name().c_str(), 100.0 * fraction);
    parts += text;
  }
  std::printf("over %.1f s: %s\n", elapsed_s, parts.c_str());
  bool well = true;
  for (bench::ChildProcess& process : processes) well &= process.stop() == 0;
  if (!well) std::printf("a process did not end well\n");
  char measured[32];
  std::snprintf(measured, sizeof measured, "%.1f %%", 100.0 * total);
  const bool met =
      bench::print_result("CPU of detector, pose and mapper at field rate, of one core", measured,
                          "<= 5 %", total <= kTarget);
  return met && well ? 0 : 1;
}
