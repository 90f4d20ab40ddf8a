// SPDX-License-Identifier: BSD-3-Clause
#include "bus/process/process.hpp"

#include <spdlog/spdlog.h>

#include <exception>
#include <iostream>
#include <stdexcept>
#include <utility>

#include "bus/bus.hpp"
#include "bus/driver/live_driver.hpp"
#include "bus/driver/paced_source.hpp"
#include "bus/node/live_node.hpp"
#include "bus/node/process_options.hpp"
#include "bus/node/stop_signal.hpp"
#include "bus/replay/lockstep_node.hpp"
#include "bus/replay/lockstep_url.hpp"
#include "io/file_error.hpp"

namespace orchard::bus {
namespace {

/// Runs the body of a process; prints an exception as one sentence and returns the exit code for
/// it.
int guarded(const std::string& name, const std::function<void()>& body) {
  const auto say = [&name](const std::exception& error) {
    std::cerr << name << ": " << error.what() << "\n";
  };
  try {
    body();
    return kExitOk;
  } catch (const io::ConfigError& error) {
    say(error);
    return kExitInput;
  } catch (const io::FileError& error) {
    say(error);
    return kExitInput;
  } catch (const std::exception& error) {
    say(error);
    return kExitRuntime;
  }
}

void log_start(const std::string& lcm_url, const ProcessOptions& options) {
  spdlog::info("version {}, {}, configuration {:016x}", version(), lcm_url,
               static_cast<std::uint64_t>(options.config.hash));
}

}  // namespace

int run_node_process(int argc, char** argv, ProcessInfo info, io::ConfigFile& config,
                     const std::function<std::unique_ptr<Node>()>& make_node,
                     const SaveHook& save) {
  ProcessOptions options;
  if (const auto code = read_options(argc, argv, info, ProcessKind::kNode, config, options)) {
    return *code;
  }
  return guarded(info.name, [&] {
    StopSignal stop;
    const std::string url = options.lockstep ? lockstep_url(config.lcm().url) : config.lcm().url;
    Bus bus(url);
    log_start(url, options);
    if (options.lockstep) {
      LockstepNode(bus, make_node, save, info.name, options.config).run(stop);
    } else {
      const std::unique_ptr<Node> node = make_node();
      LiveNode(bus, *node, info.name, options.config, save, info.alone).run(stop);
    }
  });
}

int run_driver_process(int argc, char** argv, ProcessInfo info, io::ConfigFile& config,
                       const std::function<std::unique_ptr<Source>()>& make_source) {
  ProcessOptions options;
  if (const auto code = read_options(argc, argv, info, ProcessKind::kDriver, config, options)) {
    return *code;
  }
  return guarded(info.name, [&] {
    StopSignal stop;
    Bus bus(config.lcm().url);
    log_start(config.lcm().url, options);
    const std::unique_ptr<Source> source = make_source();
    PacedSource paced(*source, options.speed);
    LiveDriver(bus, paced, info.name, options).run(stop);
  });
}

int run_device_process(int argc, char** argv, ProcessInfo info, io::ConfigFile& config,
                       const std::function<std::unique_ptr<Driver>()>& make_driver) {
  ProcessOptions options;
  if (const auto code = read_options(argc, argv, info, ProcessKind::kDevice, config, options)) {
    return *code;
  }
  return guarded(info.name, [&] {
    StopSignal stop;
    Bus bus(config.lcm().url);
    log_start(config.lcm().url, options);
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

}  // namespace orchard::bus
