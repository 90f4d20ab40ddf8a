// SPDX-License-Identifier: BSD-3-Clause
// From scan to map: the time between sending the last message that a scan's place in the map needs
// (its picture; the scan, the odometry and the poses up to the end of its sweep went before) and
// getting the MAP of that scan, with the live processes, against the same hops and sizes through
// processes that compute nothing.
// Both are measured in turn, 50 ms apart, ten times a second.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <map>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "benchmark/bench_support.hpp"
#include "benchmark/result_line.hpp"
#include "bus/messages/codec.hpp"
#include "bus/replay/in_process_replay.hpp"
#include "detector/detector_node.hpp"
#include "geometry/statistics.hpp"
#include "mapper/mapper_node.hpp"
#include "pose/pose_node.hpp"

namespace {

using namespace orchard;
using bus::Channel;
using Clock = std::chrono::steady_clock;

constexpr double kDriveS = 32.0;
constexpr int kNumWarmUp = 20;  ///< sets that are sent but not counted
constexpr double kTargetRatio = 2.5;
constexpr double kTargetP99Ms = 5.0;
constexpr auto kHalfPeriod = std::chrono::milliseconds(50);
constexpr const char* kRelayUrl = "udpm://239.255.76.68:7668?ttl=0&recv_buf_size=4194304";

/// What a scan's place in the map needs, and what the pipeline makes of it.
struct MessageSet : bench::ScanSet {
  bench::RelayHeader header;
};

/// Sizes of what the pipeline makes of each scan, from a replay in this process.
std::map<std::int64_t, bench::RelayHeader> derived_sizes(const bench::FieldDrive& drive) {
  std::map<std::int64_t, bench::RelayHeader> headers;
  procs::DetectorNode detector(drive.config);
  procs::PoseNode pose(drive.config);
  procs::MapperNode mapper(drive.config);
  bus::ReplayOptions options;
  options.on_derived = [&headers](Channel channel, std::int64_t utime, const auto& bytes) {
    bench::RelayHeader& header = headers[utime];
    const auto size = static_cast<std::uint32_t>(bytes.size());
    if (channel == Channel::kDetections) header.detections_bytes = size;
    if (channel == Channel::kPose) header.pose_bytes = size;
    if (channel == Channel::kMap) header.map_bytes = size;
  };
  bus::replay_in_process(drive.log_path, {&detector, &pose, &mapper}, options);
  return headers;
}

std::vector<MessageSet> make_sets(const bench::FieldDrive& drive) {
  const auto headers = derived_sizes(drive);
  std::vector<MessageSet> sets;
  for (bench::ScanSet& scan : bench::scan_sets(drive)) {
    MessageSet set{std::move(scan), {}};
    set.header = headers.at(set.utime);
    set.header.utime = set.utime;
    set.header.num_detector_inputs = set.num_detector_inputs;
    sets.push_back(std::move(set));
  }
  return sets;
}

double through_relays(bench::MapProbe& probe, const MessageSet& set, Clock::time_point until) {
  for (const bench::RawMessage* input : set.inputs) {
    std::vector<std::uint8_t> bytes(input->bytes.size());
    std::memcpy(bytes.data(), &set.header, sizeof set.header);
    probe.send(input->channel, bytes);
  }
  return probe.wait_for_map(set.utime, until);
}

void print_quantiles(const char* name, const std::vector<double>& times_ms) {
  std::printf("%s, %zu scans: p50 %.3f ms, p90 %.3f ms, p99 %.3f ms, most %.3f ms\n", name,
              times_ms.size(), geometry::median(times_ms), geometry::quantile(times_ms, 0.9),
              geometry::quantile(times_ms, 0.99), geometry::quantile(times_ms, 1.0));
}

bool report(const std::vector<double>& pipeline_ms, const std::vector<double>& relay_ms,
            int num_missing) {
  print_quantiles("live processes", pipeline_ms);
  print_quantiles("bare LCM relay", relay_ms);
  const double ratio = geometry::median(pipeline_ms) / geometry::median(relay_ms);
  const double p99_ms = geometry::quantile(pipeline_ms, 0.99);
  char text[96];
  std::snprintf(text, sizeof text, "%.2fx (%.2f ms against %.2f ms)", ratio,
                geometry::median(pipeline_ms), geometry::median(relay_ms));
  bool met = bench::print_result("scan to map, p50, against a bare LCM relay", text, "<= 2.5x",
                                 ratio <= kTargetRatio);
  std::snprintf(text, sizeof text, "%.2f ms", p99_ms);
  met &= bench::print_result("scan to map, p99", text, "<= 5 ms", p99_ms <= kTargetP99Ms);
  met &= bench::print_result("scans without a MAP within 45 ms", std::to_string(num_missing), "0",
                             num_missing == 0);
  return met;
}

/// How long the detector and the mapper alone compute for the median scan, without any bus, when
/// one scan follows the last after a pause [ms].
std::pair<double, double> alone_ms(const bench::FieldDrive& drive,
                                   const std::vector<MessageSet>& sets,
                                   std::chrono::milliseconds pause) {
  procs::DetectorNode detector(drive.config);
  procs::PoseNode pose(drive.config);
  procs::MapperNode mapper(drive.config);
  std::vector<bus::Message> outputs;
  const bus::Outbox keep = [&outputs](bus::Message made) { outputs.push_back(std::move(made)); };
  const auto timed_ms = [&](bus::Node& node, const bus::Message& input) {
    const auto begin = Clock::now();
    node.handle(input, keep);
    return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
  };
  std::vector<double> detector_ms, mapper_ms;
  for (std::size_t i = 0; i < std::min<std::size_t>(sets.size(), 50); ++i) {
    std::this_thread::sleep_for(pause);
    double sum_ms = 0.0;
    for (const bench::RawMessage* input : sets[i].inputs) {
      const auto decoded = bus::decode(input->channel, input->bytes.data(), input->bytes.size());
      const auto& message = std::get<bus::Message>(decoded);
      if (input->channel == Channel::kPoseFix) {
        pose.handle(message, keep);
      } else {
        const double elapsed_ms = timed_ms(detector, message);
        if (input->channel == Channel::kImage) detector_ms.push_back(elapsed_ms);
      }
      if (input->channel == Channel::kScan) sum_ms += timed_ms(mapper, message);
    }
    for (const bus::Message& output : std::exchange(outputs, {})) {
      if (bus::channel_of(output) != Channel::kMap) sum_ms += timed_ms(mapper, output);
    }
    mapper_ms.push_back(sum_ms);
  }
  return {geometry::median(detector_ms), geometry::median(mapper_ms)};
}

}  // namespace

int main(int argc, char** argv) {
  if (bench::is_relay(argc, argv)) return bench::run_relay(argv);
  const std::string problem = bench::enter_private_network();
  if (!problem.empty()) {
    std::printf("bench_latency: %s\n", problem.c_str());
    return 1;
  }
  const bench::TemporaryFolder folder;
  const bench::FieldDrive drive = bench::simulate_field_drive(folder.path(""), kDriveS, 10.0, true);
  bench::describe_drive(drive);
  const std::vector<MessageSet> sets = make_sets(drive);

  auto processes = bench::start_live_pipeline(drive.config_path, drive.config.lcm.url, folder);
  const auto relays = bench::start_relays(kRelayUrl, folder);
  bench::MapProbe live(drive.config.lcm.url, false);
  bench::MapProbe relay(kRelayUrl, true);

  std::vector<double> pipeline_ms, relay_ms;
  int num_missing = 0;
  Clock::time_point next = Clock::now();
  for (std::size_t i = 0; i < sets.size(); ++i) {
    const auto slack = std::chrono::milliseconds(5);
    std::this_thread::sleep_until(next);
    next += kHalfPeriod;
    const double pipeline = live.through(sets[i], next - slack);
    std::this_thread::sleep_until(next);
    next += kHalfPeriod;
    const double bare = through_relays(relay, sets[i], next - slack);
    if (i < kNumWarmUp) continue;
    if (pipeline >= 0.0) pipeline_ms.push_back(pipeline);
    if (bare >= 0.0) relay_ms.push_back(bare);
    num_missing += pipeline < 0.0 ? 1 : 0;
  }
  for (bench::ChildProcess& process : processes) process.stop();
  if (pipeline_ms.empty() || relay_ms.empty()) {
    std::printf("bench_latency: no MAP came back\n");
    return 1;
  }
  const bool met = report(pipeline_ms, relay_ms, num_missing);
  for (const int pause_ms : {0, 100}) {
    const auto [detector_ms, mapper_ms] =
        alone_ms(drive, sets, std::chrono::milliseconds(pause_ms));
    std::printf(
        "computation alone, %s: detector %.3f ms, mapper %.3f ms of the median scan\n",
        pause_ms == 0 ? "one scan after the other" : "ten scans a second (caches gone cold)",
        detector_ms, mapper_ms);
  }
  return met ? 0 : 1;
}
