// SPDX-License-Identifier: BSD-3-Clause
#include "bus/process/process.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <variant>

#include "bus/bus.hpp"
#include "bus/driver/device_server.hpp"
#include "bus/driver/live_driver.hpp"
#include "bus/driver/port.hpp"
#include "bus/driver/source.hpp"
#include "bus/driver/stream_driver.hpp"
#include "bus/node/live_node.hpp"
#include "bus/node/process_options.hpp"
#include "bus/node/stop_signal.hpp"
#include "bus/replay/lockstep_node.hpp"
#include "io/file_error.hpp"
#include "text/parse_number.hpp"

namespace orchard::bus {
namespace {

/// Reads the options, opens the bus and runs the body of a process.
int run_process(int argc, char** argv, const ProcessInfo& info, ProcessKind kind,
                io::ConfigFile& config,
                const std::function<void(const ProcessOptions&, StopSignal&, Bus&)>& body) {
  ProcessOptions options;
  if (const auto code = read_options(argc, argv, info, kind, config, options)) return *code;
  return run_guarded(info.name, [&] {
    StopSignal stop;
    const std::string url = options.lockstep ? lockstep_url(config.lcm().url) : config.lcm().url;
    Bus bus(url);
    spdlog::info("version {}, {}, configuration {:016x}", version(), url,
                 static_cast<std::uint64_t>(options.config.hash));
    body(options, stop, bus);
    return kExitOk;
  });
}

/// Values of the command-line options.
struct StreamOptions {
  std::string device;
  std::string raw_out;
  std::string raw_in;
  std::string emulate;
  std::string emulate_at;
};

/// Plays a log through an emulated device on a port of its own, together with the driver that reads
/// that port, in one loop.
class EmulatedDriver : public Driver {
 public:
  EmulatedDriver(const StreamDevice& device, const std::string& log_path, std::int64_t start_utime,
                 const std::string& raw_out)
      : log_(log_path, start_utime, device.channels),
        server_(device.make_emulated(), device.emulated_at),
        driver_(device.make_protocol(), parse_port(server_.address()), raw_out) {}

  std::vector<pollfd> files() override {
    std::vector<pollfd> files = driver_.files();
    const std::vector<pollfd> others = server_.files();
    files.insert(files.end(), others.begin(), others.end());
    return files;
  }
  Clock::time_point deadline() override {
    return std::min({driver_.deadline(), server_.deadline(), log_.deadline()});
  }
  void step(const Outbox& send) override {
    while (const auto message = log_.take_due()) play(*message);
    server_.step();
    driver_.step(send);
  }
  DriverCondition condition() const override { return driver_.condition(); }

 private:
  void play(const Message& message) {
    std::visit(
        [this](const auto& m) {
          using M = std::decay_t<decltype(m)>;
          if constexpr (std::is_constructible_v<device::Measurement, M>) server_.measured(m);
        },
        message);
  }

  PlayedLog log_;
  DeviceServer server_;
  StreamDriver driver_;
};

/// Publishes the scans of a driver as those of the robot's second scanner (SCAN.rear).
class RearDriver : public Driver {
 public:
  explicit RearDriver(std::unique_ptr<Driver> driver) : driver_(std::move(driver)) {}

  std::vector<pollfd> files() override { return driver_->files(); }
  Clock::time_point deadline() override { return driver_->deadline(); }
  void step(const Outbox& send) override {
    driver_->step([&send](Message message) {
      if (auto* scan = std::get_if<laser::Scan>(&message)) {
        message = Message(laser::RearScan{std::move(*scan)});
      }
      send(std::move(message));
    });
  }
  bool ended() const override { return driver_->ended(); }
  DriverCondition condition() const override { return driver_->condition(); }

 private:
  std::unique_ptr<Driver> driver_;
};

std::unique_ptr<Driver> make_driver(const StreamDevice& device, const StreamOptions& options) {
  if (!options.raw_in.empty()) {
    return std::make_unique<PacedSource>(
        std::make_unique<RawSource>(device.make_protocol(), options.raw_in), 1.0);
  }
  if (options.emulate.empty()) {
    const std::string& where = options.device.empty() ? device.device : options.device;
    if (where.empty()) {
      throw std::invalid_argument(
          "no device is given: set it in section drivers of the rig or by --device; without "
          "hardware use --emulate LOG");
    }
    return std::make_unique<StreamDriver>(device.make_protocol(), parse_port(where),
                                          options.raw_out);
  }
  return std::make_unique<EmulatedDriver>(
      device, options.emulate, parse_utime("--emulate-at", options.emulate_at), options.raw_out);
}

}  // namespace

int run_guarded(const std::string& name, const std::function<int()>& body) {
  const auto say = [&name](const std::exception& error, ExitCode code) {
    std::cerr << name << ": " << error.what() << "\n";
    return code;
  };
  try {
    return body();
  } catch (const io::ConfigError& error) {
    return say(error, kExitInput);
  } catch (const io::SystemError& error) {
    return say(error, kExitRuntime);
  } catch (const io::FileError& error) {
    return say(error, kExitInput);
  } catch (const std::exception& error) {
    return say(error, kExitRuntime);
  }
}

int run_node_process(int argc, char** argv, ProcessInfo info, io::ConfigFile& config,
                     const std::function<std::unique_ptr<Node>()>& make_node,
                     const SaveHook& save) {
  return run_process(
      argc, argv, info, ProcessKind::kNode, config,
      [&](const ProcessOptions& options, StopSignal& stop, Bus& bus) {
        if (options.lockstep) {
          return LockstepNode(bus, make_node, save, info.name, options.config).run(stop);
        }
        const std::unique_ptr<Node> node = make_node();
        LiveNode(bus, *node, info.name, options.config, save, info.alone).run(stop);
      });
}

int run_driver_process(int argc, char** argv, ProcessInfo info, io::ConfigFile& config,
                       const std::function<std::unique_ptr<Source>()>& make_source) {
  return run_process(argc, argv, info, ProcessKind::kDriver, config,
                     [&](const ProcessOptions& options, StopSignal& stop, Bus& bus) {
                       PacedSource paced(make_source(), options.speed);
                       LiveDriver(bus, paced, info.name, options).run(stop);
                     });
}

int run_device_process(int argc, char** argv, ProcessInfo info, io::ConfigFile& config,
                       const std::function<std::unique_ptr<Driver>()>& make_driver) {
  return run_process(argc, argv, info, ProcessKind::kDevice, config,
                     [&](const ProcessOptions& options, StopSignal& stop, Bus& bus) {
                       const std::unique_ptr<Driver> driver = [&] {
                         try {
                           return make_driver();
                         } catch (const std::invalid_argument& error) {
                           throw io::FileError(error.what());  // invalid address or file
                         }
                       }();
                       LiveDriver(bus, *driver, info.name, options).run(stop);
                     });
}

std::int64_t parse_utime(const std::string& option, const std::string& text) {
  if (text.empty()) return 0;
  const auto utime = parse_number<std::int64_t>(text);
  if (utime && *utime >= 0) return *utime;
  throw std::invalid_argument(option + " " + text + ": must be microseconds since 1970");
}

int run_stream_process(int argc, char** argv, ProcessInfo info, io::ConfigFile& config,
                       const std::function<StreamDevice()>& make_device) {
  StreamOptions options;
  const std::vector<ExtraOption> more = {
      {"--device", "PORT",
       "address of the device, tcp:HOST:PORT or serial:FILE:BAUD [from the configuration]",
       &options.device},
      {"--raw-out", "FILE", "record the raw bytes of the device to this file", &options.raw_out},
      {"--raw-in", "FILE", "read raw bytes from this recording instead of the device",
       &options.raw_in},
      {"--emulate", "LOG",
       "emulate the device: replay the measurements of this log in its protocol", &options.emulate},
      {"--emulate-at", "UTIME",
       "time of this machine at the first event of the emulated log [us] [now]",
       &options.emulate_at},
  };
  info.options.insert(info.options.end(), more.begin(), more.end());
  return run_device_process(argc, argv, info, config, [&]() -> std::unique_ptr<Driver> {
    const StreamDevice device = make_device();
    std::unique_ptr<Driver> driver = make_driver(device, options);
    if (!device.is_rear) return driver;
    return std::make_unique<RearDriver>(std::move(driver));
  });
}

}  // namespace orchard::bus
