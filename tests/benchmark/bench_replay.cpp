// SPDX-License-Identifier: BSD-3-Clause
// How many times faster than it was driven a log is replayed: in one process on one core, and in
// lockstep through real processes over multicast; and what lcm-logplayer --speed=0 loses of it.
#include <sched.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "benchmark/bench_support.hpp"
#include "benchmark/result_line.hpp"
#include "bus/bus.hpp"
#include "bus/node/node.hpp"
#include "bus/node/stop_signal.hpp"
#include "bus/replay/in_process_replay.hpp"
#include "bus/replay/lockstep.hpp"
#include "bus/replay/replay_index.hpp"
#include "detector/detector_node.hpp"
#include "geometry/statistics.hpp"
#include "mapper/mapper_node.hpp"
#include "pose/pose_node.hpp"

namespace {

using namespace orchard;
using bench::ChildProcess;
using bench::FieldDrive;
using Clock = std::chrono::steady_clock;

constexpr double kDriveS = 60.0;
constexpr double kInProcessTarget = 200.0;
constexpr double kLockstepTarget = 50.0;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

std::string factor_text(double factor) {
  char text[64];
  std::snprintf(text, sizeof text, "%.0fx real time", factor);
  return text;
}

/// A node that notes how long the real one takes.
class TimedNode : public bus::Node {
 public:
  explicit TimedNode(std::unique_ptr<bus::Node> node) : node_(std::move(node)) {}
  std::string_view name() const override { return node_->name(); }
  std::vector<bus::Channel> inputs() const override { return node_->inputs(); }
  void handle(const bus::Message& input, const bus::Outbox& send) override {
    const auto begin = Clock::now();
    node_->handle(input, [&](bus::Message message) { outputs_.push_back(std::move(message)); });
    elapsed_s_ += seconds_since(begin);
    for (bus::Message& message : outputs_) send(std::move(message));
    outputs_.clear();
  }
  void flush(const bus::Outbox& send) override { node_->flush(send); }
  double elapsed_s() const { return elapsed_s_; }

 private:
  std::unique_ptr<bus::Node> node_;
  std::vector<bus::Message> outputs_;
  double elapsed_s_ = 0.0;
};

std::vector<std::unique_ptr<bus::Node>> make_nodes(const io::Config& config) {
  std::vector<std::unique_ptr<bus::Node>> nodes;
  nodes.push_back(std::make_unique<procs::DetectorNode>(config));
  nodes.push_back(std::make_unique<procs::PoseNode>(config));
  nodes.push_back(std::make_unique<procs::MapperNode>(config));
  return nodes;
}

/// FNV-1a over channel and bytes of derived messages, in the order in which they were passed on.
struct Fingerprint {
  std::uint64_t hash = 14695981039346656037u;
  void add(bus::Channel channel, const std::vector<std::uint8_t>& bytes) {
    add(static_cast<std::uint8_t>(channel));
    for (const std::uint8_t byte : bytes) add(byte);
  }
  void add(std::uint8_t byte) { hash = (hash ^ byte) * 1099511628211u; }
};

struct Replayed {
  bus::ReplayReport report;
  std::uint64_t fingerprint = 0;
  double elapsed_s = 0.0;
};

Replayed replay_once(const FieldDrive& drive, const std::vector<bus::Node*>& nodes) {
  Replayed replayed;
  Fingerprint fingerprint;
  bus::ReplayOptions options;
  options.on_derived = [&](bus::Channel channel, std::int64_t, const auto& bytes) {
    fingerprint.add(channel, bytes);
  };
  const auto begin = Clock::now();
  replayed.report = bus::replay_in_process(drive.log_path, nodes, options);
  replayed.elapsed_s = seconds_since(begin);
  replayed.fingerprint = fingerprint.hash;
  return replayed;
}

std::vector<bus::Node*> pointers(const std::vector<std::unique_ptr<bus::Node>>& nodes) {
  std::vector<bus::Node*> result;
  for (const auto& node : nodes) result.push_back(node.get());
  return result;
}

/// Where the time of an in-process replay goes.
void print_fractions(const FieldDrive& drive) {
  std::vector<std::unique_ptr<bus::Node>> timed;
  for (auto& node : make_nodes(drive.config)) {
    timed.push_back(std::make_unique<TimedNode>(std::move(node)));
  }
  const Replayed replayed = replay_once(drive, pointers(timed));
  const auto begin = Clock::now();
  bus::index_log(drive.log_path, {});
  const double index_s = seconds_since(begin);
  std::printf("  of %.0f ms: reading, checking and sorting the log %.0f ms",
              1e3 * replayed.elapsed_s, 1e3 * index_s);
  double known_s = index_s;
  for (const auto& node : timed) {
    const double node_s = static_cast<const TimedNode&>(*node).elapsed_s();
    std::printf(", %s %.0f ms", std::string(node->name()).c_str(), 1e3 * node_s);
    known_s += node_s;
  }
  std::printf(", messages (read again, decode, encode, hash) %.0f ms\n",
              1e3 * (replayed.elapsed_s - known_s));
}

/// Everything on one core while it lives.
class OneCore {
 public:
  OneCore() {
    sched_getaffinity(0, sizeof before_, &before_);
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(sched_getcpu(), &one);
    sched_setaffinity(0, sizeof one, &one);
  }
  ~OneCore() { sched_setaffinity(0, sizeof before_, &before_); }

 private:
  cpu_set_t before_;
};

Replayed bench_in_process(const FieldDrive& drive, bool& met) {
  const OneCore one_core;
  std::vector<double> factors;
  Replayed replayed;
  for (int i = 0; i < 7; ++i) {
    const auto nodes = make_nodes(drive.config);
    replayed = replay_once(drive, pointers(nodes));
    factors.push_back(drive.duration_s / replayed.elapsed_s);
  }
  const double factor = geometry::median(factors);
  met &= bench::print_result("replay in one process, one core", factor_text(factor),
                             ">= " + factor_text(kInProcessTarget), factor >= kInProcessTarget);
  print_fractions(drive);
  return replayed;
}

std::int64_t total(const std::array<std::int64_t, bus::kNumChannels>& counts) {
  std::int64_t sum = 0;
  for (const std::int64_t count : counts) sum += count;
  return sum;
}

void bench_lockstep(const FieldDrive& drive, const Replayed& expected,
                    const bench::TemporaryFolder& folder, bool& met) {
  bus::StopSignal stop;
  std::vector<ChildProcess> nodes;
  for (const char* name : {"detector", "pose", "mapper"}) {
    nodes.emplace_back(
        std::vector<std::string>{bench::built_program(std::string("orchard-") + name), "--config",
                                 drive.config_path, "--lockstep"},
        folder.path(name));
  }
  std::vector<double> factors;
  std::int64_t num_lost = 0, num_resent = 0;
  bool same = true;
  for (int i = 0; i < 5; ++i) {
    // A bus of its own each time, as each run of the player has.
    bus::Bus player_bus(bus::lockstep_url(drive.config.lcm.url));
    Fingerprint fingerprint;
    bus::LockstepOptions options;
    options.replay.on_derived = [&](bus::Channel channel, std::int64_t, const auto& bytes) {
      fingerprint.add(channel, bytes);
    };
    const auto report = bus::replay_in_lockstep(drive.log_path, player_bus, stop, options);
    if (report.stopped) {
      std::printf("stopped during replay %d in lockstep: no figure\n", i + 1);
      met = false;
      return;
    }
    factors.push_back(drive.duration_s / report.elapsed_s);
    num_lost += total(expected.report.num_in) - total(report.replay.num_in) +
                total(expected.report.num_out) - total(report.replay.num_out);
    num_resent += report.num_resent;
    same &= fingerprint.hash == expected.fingerprint;
  }
  for (ChildProcess& node : nodes) {
    if (node.stop() != 0) std::printf("%s did not end well\n", node.name().c_str());
  }
  const double factor = geometry::median(factors);
  met &= bench::print_result("replay in lockstep over multicast", factor_text(factor),
                             ">= " + factor_text(kLockstepTarget), factor >= kLockstepTarget);
  met &= bench::print_result(
      "lost in lockstep, of " +
          std::to_string(5 * (total(expected.report.num_in) + total(expected.report.num_out))),
      std::to_string(num_lost) + " (" + std::to_string(num_resent) +
          " sent again), derived bytes " + (same ? "as in one process" : "DIFFER"),
      "0", num_lost == 0 && same);
}

void bench_logplayer(const FieldDrive& drive, const bench::TemporaryFolder& folder) {
  for (const int capacity : {30, 0}) {
    std::vector<double> fractions;
    for (int i = 0; i < 3; ++i) {
      const std::int64_t received =
          bench::count_played(drive.log_path, drive.config.lcm.url, capacity, folder);
      fractions.push_back(1.0 - static_cast<double>(received) /
                                    static_cast<double>(drive.messages.size()));
    }
    char text[64];
    std::snprintf(text, sizeof text, "%.1f %%", 100.0 * geometry::median(fractions));
    bench::print_figure("lcm-logplayer --speed=0 loses of the same log, subscriber's queue " +
                            (capacity > 0 ? "of " + std::to_string(capacity) + " (LCM's default)"
                                          : std::string("without limit")),
                        text);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (bench::is_counter(argc, argv)) return bench::run_counter(argv);
  const std::string problem = bench::enter_private_network();
  if (!problem.empty()) {
    std::printf("bench_replay: %s\n", problem.c_str());
    return 1;
  }
  const bench::TemporaryFolder folder;
  const FieldDrive drive = bench::simulate_field_drive(folder.path(""), kDriveS, 1.0, false);
  bench::describe_drive(drive);
  bool met = true;
  const Replayed replayed = bench_in_process(drive, met);
  bench_lockstep(drive, replayed, folder, met);
  bench_logplayer(drive, folder);
  return met ? 0 : 1;
}
