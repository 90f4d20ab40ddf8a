// SPDX-License-Identifier: BSD-3-Clause
#include "log_player/player.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include "bus/driver/live_driver.hpp"
#include "bus/driver/source.hpp"
#include "bus/node/stop_signal.hpp"
#include "bus/replay/lockstep.hpp"
#include "bus/replay/replay_index.hpp"
#include "detector/detector_node.hpp"
#include "io/log/log_reader.hpp"
#include "io/log/log_writer.hpp"
#include "io/progress_bar.hpp"
#include "log_player/verification.hpp"
#include "mapper/mapper_node.hpp"
#include "pose/pose_node.hpp"

namespace orchard::procs {
namespace {

/// Source of the sensor messages of a log, in replay order.
class LogSource : public bus::Source {
 public:
  /// Throws io::FileError as bus::index_log does.
  LogSource(const std::string& log_path, const bus::ReplayOptions& options)
      : index_(bus::index_log(log_path, options)),
        next_(index_.entries.begin()),
        reader_(log_path) {}

  std::optional<bus::Message> next() override {
    if (next_ == index_.entries.end()) return std::nullopt;
    const bus::ReplayEntry entry = *next_;
    ++next_;
    const std::vector<std::uint8_t> bytes = reader_.read_at(entry.offset).data;
    // The index holds only messages that passed the guard.
    return std::get<bus::Message>(bus::decode(entry.channel, bytes.data(), bytes.size()));
  }
  std::optional<double> duration_s() const override {
    return 1e-6 * static_cast<double>(index_.report.last_utime - index_.report.first_utime);
  }
  const bus::ReplayReport& report() const { return index_.report; }

 private:
  bus::ReplayIndex index_;
  bus::ReplayEntries::Iterator next_;
  io::LogReader reader_;
};

/// Sink of derived messages: a log, a comparison, or both.
class Sink {
 public:
  explicit Sink(const PlayerOptions& options) {
    if (options.verify) verification_ = std::make_unique<Verification>(options.log_path);
    if (!options.out_path.empty()) writer_ = std::make_unique<io::LogWriter>(options.out_path);
  }

  void take(bus::Channel channel, std::int64_t utime, const std::vector<std::uint8_t>& bytes) {
    if (writer_) writer_->write(utime, bus::info(channel).name, bytes);
    if (verification_) verification_->take(channel, bytes);
  }

  /// Returns the exit code.
  int finish() {
    if (writer_) writer_->close();
    if (!verification_) return bus::kExitOk;
    verification_->finish();
    for (const std::string& line : verification_->describe()) std::printf("%s\n", line.c_str());
    std::printf("%s\n", verification_->equal()
                            ? "verified: the replay reproduces the derived messages of the log"
                            : "NOT verified");
    return verification_->equal() ? bus::kExitOk : bus::kExitRuntime;
  }

 private:
  std::unique_ptr<io::LogWriter> writer_;
  std::unique_ptr<Verification> verification_;
};

void print_report(const bus::ReplayReport& report, double elapsed_s) {
  for (const std::string& warning : report.warnings) spdlog::warn("{}", warning);
  for (const bus::ChannelInfo& channel : bus::kChannels) {
    const auto i = static_cast<std::size_t>(channel.channel);
    if (report.num_in[i] > 0) {
      std::printf("in   %-10s %8lld\n", std::string(channel.name).c_str(),
                  static_cast<long long>(report.num_in[i]));
    }
    if (report.num_out[i] > 0) {
      std::printf("out  %-10s %8lld\n", std::string(channel.name).c_str(),
                  static_cast<long long>(report.num_out[i]));
    }
  }
  const double log_s = static_cast<double>(report.last_utime - report.first_utime) * 1e-6;
  std::printf("%.1f s of log in %.3f s", log_s, elapsed_s);
  if (elapsed_s > 0) std::printf(" (%.0f x real time)", log_s / elapsed_s);
  std::printf("\n");
}

bus::ReplayOptions replay_options(const PlayerOptions& options, Sink& sink, io::ProgressBar& bar) {
  bus::ReplayOptions replay = options.replay;
  replay.progress = [&bar](std::uint64_t done, std::uint64_t total) { bar.update(done, total); };
  replay.on_derived = [&sink](bus::Channel channel, std::int64_t utime,
                              const std::vector<std::uint8_t>& bytes) {
    sink.take(channel, utime, bytes);
  };
  return replay;
}

int play_in_process(const PlayerOptions& options) {
  Sink sink(options);
  io::ProgressBar bar("replaying");
  const auto start = std::chrono::steady_clock::now();
  DetectorNode detector(options.rig.config());
  PoseNode pose(options.rig.config());
  MapperNode mapper(options.rig.config());
  const bus::ReplayReport report = bus::replay_in_process(
      options.log_path, {&detector, &pose, &mapper}, replay_options(options, sink, bar));
  bar.finish();
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  print_report(report, elapsed.count());
  return sink.finish();
}

int play_in_lockstep(const PlayerOptions& options) {
  Sink sink(options);
  io::ProgressBar bar("replaying in lockstep");
  bus::StopSignal stop;
  bus::Bus bus(bus::lockstep_url(options.rig.config().lcm.url));
  bus::LockstepOptions lockstep;
  lockstep.replay = replay_options(options, sink, bar);
  lockstep.nodes = options.nodes;
  lockstep.start_timeout_s = options.start_timeout_s;
  lockstep.say = [](const std::string& text) { spdlog::info("{}", text); };
  const bus::LockstepReport report = bus::replay_in_lockstep(options.log_path, bus, stop, lockstep);
  bar.finish();
  if (report.stopped) {
    spdlog::warn("stopped before the end of the log: no output was written");
    return bus::kExitOk;
  }
  print_report(report.replay, report.elapsed_s);
  std::printf("lockstep: no message lost, %lld repeated\n",
              static_cast<long long>(report.num_resent));
  return sink.finish();
}

int play_paced(const PlayerOptions& options) {
  auto source = std::make_unique<LogSource>(options.log_path, options.replay);
  for (const std::string& warning : source->report().warnings) spdlog::warn("{}", warning);
  bus::StopSignal stop;
  bus::Bus bus(options.rig.config().lcm.url);
  bus::PacedSource paced(std::move(source), options.process.speed);
  bus::LiveDriver(bus, paced, "orchard-log-player", options.process).run(stop);
  return bus::kExitOk;
}

}  // namespace

int play(const PlayerOptions& options) {
  switch (options.mode) {
    case PlayerMode::kInProcess:
      return play_in_process(options);
    case PlayerMode::kLockstep:
      return play_in_lockstep(options);
    case PlayerMode::kPaced:
      return play_paced(options);
  }
  return bus::kExitRuntime;
}

}  // namespace orchard::procs
