// SPDX-License-Identifier: BSD-3-Clause
// What do 20 people cost who look on? The time from scan to map of the live processes, in turn 7 s
// with orchard-viewer and 20 event streams that are read, and 7 s without (the viewer stands
// still).
//   bench_viewers [SECONDS]   of each of both (default 60)
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "benchmark/bench_support.hpp"
#include "benchmark/result_line.hpp"
#include "geometry/statistics.hpp"

namespace {

using namespace orchard;
using Clock = std::chrono::steady_clock;

constexpr int kNumViewers = 20;
constexpr double kTargetRatio = 1.1;
constexpr int kSetsOfPart = 100;   ///< ten seconds of ten scans
constexpr int kSetsToSettle = 30;  ///< of them, not counted: streams begin, a backlog is read
constexpr auto kPeriod = std::chrono::milliseconds(100), kPause = std::chrono::milliseconds(5);
constexpr double kWaited_ms = std::chrono::duration<double, std::milli>(kPeriod - kPause).count();
constexpr const char* kAddress = "127.0.0.1:8420";

/// orchard-viewer and who looks on; both stand still between their parts.
class Viewers {
 public:
  Viewers(const bench::FieldDrive& drive, const bench::TemporaryFolder& folder)
      : viewer_({bench::built_program("orchard-viewer"), "--config", drive.config_path, "--listen",
                 kAddress},
                folder.path("viewer.log")),
        streams_({"python3", "-B", ORCHARD_LOOK_ON, kAddress, std::to_string(kNumViewers)},
                 folder.path("streams.log")) {}
  void go_on(bool is_on) {
    viewer_.signal(is_on ? SIGCONT : SIGSTOP);
    streams_.signal(is_on ? SIGCONT : SIGSTOP);
  }

 private:
  bench::ChildProcess viewer_, streams_;
};

std::string quantiles(const std::vector<double>& times_ms) {
  char text[120];
  std::snprintf(text, sizeof text, "p50 %.2f, p90 %.2f, p99 %.2f ms of %zu scans",
                geometry::median(times_ms), geometry::quantile(times_ms, 0.9),
                geometry::quantile(times_ms, 0.99), times_ms.size());
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 60.0;
  const std::string problem = bench::enter_private_network();
  if (!problem.empty()) {
    std::printf("bench_viewers: %s\n", problem.c_str());
    return 1;
  }
  const bench::TemporaryFolder folder;
  const double share = static_cast<double>(kSetsOfPart) / (kSetsOfPart - kSetsToSettle);
  const bench::FieldDrive drive =
      bench::simulate_field_drive(folder.path(""), 2.0 * share * seconds + 2.0, 10.0, true);
  bench::describe_drive(drive);
  const std::vector<bench::ScanSet> sets = bench::scan_sets(drive);
  auto processes = bench::start_live_pipeline(drive.config_path, drive.config.lcm.url, folder);
  bench::MapProbe probe(drive.config.lcm.url, false);
  Viewers viewers(drive, folder);

  std::vector<double> with_ms, without_ms;
  int num_missing_with = 0, num_missing_without = 0;
  Clock::time_point next = Clock::now();
  for (std::size_t i = 0; i < sets.size(); ++i) {
    const std::size_t part = i / kSetsOfPart;
    const bool is_watched = part % 2 == 0;
    if (i % kSetsOfPart == 0) viewers.go_on(is_watched);
    std::this_thread::sleep_until(next);
    next += kPeriod;
    const double time_ms = probe.through(sets[i], next - kPause);
    if (part < 2 || i % kSetsOfPart < kSetsToSettle) continue;
    if (time_ms < 0.0) ++(is_watched ? num_missing_with : num_missing_without);
    // What never came took at least as long as was waited for it.
    (is_watched ? with_ms : without_ms).push_back(time_ms < 0.0 ? kWaited_ms : time_ms);
  }
  viewers.go_on(true);
  for (bench::ChildProcess& process : processes) process.stop();
  const auto num_missing = static_cast<std::size_t>(num_missing_with + num_missing_without);
  if (num_missing == with_ms.size() + without_ms.size()) {
    std::printf("bench_viewers: no MAP came back\n");
    return 1;
  }
  std::printf("20 look on: %s\nnobody does: %s\n", quantiles(with_ms).c_str(),
              quantiles(without_ms).c_str());
  const double p99_with_ms = geometry::quantile(with_ms, 0.99);
  const double p99_without_ms = geometry::quantile(without_ms, 0.99);
  if (std::max(p99_with_ms, p99_without_ms) >= kWaited_ms) {
    std::printf(
        "bench_viewers: over 1 %% of the scans had no MAP in time, so nothing is known of "
        "p99; the machine has too much else to do\n");
    return 1;
  }
  const double ratio = p99_with_ms / p99_without_ms;
  char text[40];
  std::snprintf(text, sizeof text, "%.2fx", ratio);
  const bool met = bench::print_result("scan to map, p99, 20 who look on against nobody", text,
                                       "<= 1.1x", ratio <= kTargetRatio);
  bench::print_figure(
      "scans without a MAP within 95 ms, 20 who look on, nobody",
      std::to_string(num_missing_with) + ", " + std::to_string(num_missing_without));
  return met ? 0 : 1;
}
