// SPDX-License-Identifier: BSD-3-Clause
#include "cli/logs/echo.hpp"

#include <cstdio>
#include <exception>

#include "bus/bus.hpp"
#include "bus/node/stop_signal.hpp"
#include "bus/process/process.hpp"
#include "cli/field/field_url.hpp"
#include "cli/logs/message_text.hpp"

namespace orchard::cli {
namespace {

using bus::Channel;

std::string channel_names() {
  std::string names;
  for (const bus::ChannelInfo& channel : bus::kChannels) {
    names += (names.empty() ? "" : ", ") + std::string(channel.name);
  }
  return names;
}

void echo(Channel channel, const EchoOptions& options, const std::string& lcm_url) {
  bus::StopSignal stop;
  bus::Bus bus(lcm_url);
  std::int64_t num_printed = 0;
  const auto print = [&](const auto& message) {
    std::printf("%s\n", message_text(message, options.json).c_str());
    std::fflush(stdout);
    ++num_printed;
  };
  switch (channel) {
    case Channel::kStatus:
      bus.subscribe_status(print);
      break;
    case Channel::kConfig:
      bus.subscribe_config(print);
      break;
    case Channel::kAck:
      bus.subscribe_ack(print);
      break;
    case Channel::kReplay:
      bus.subscribe_replay(print);
      break;
    default:
      bus.subscribe(channel, [&](const bus::Message& m, bus::Bytes) { print(m); });
  }
  while (!stop.raised() && (options.count == 0 || num_printed < options.count)) {
    if (stop.wait(bus.fileno(), 5000)) {
      bus.handle(0);
    } else if (num_printed == 0 && !stop.raised()) {
      std::fprintf(stderr, "orchard echo: no message on %s yet; LCM network: %s\n",
                   std::string(bus::info(channel).name).c_str(), lcm_url.c_str());
    }
  }
}

}  // namespace

int run_echo(const EchoOptions& options) {
  const auto channel = bus::find_channel(options.channel);
  if (!channel) {
    std::fprintf(stderr, "orchard echo: unknown channel \"%s\"; choose one of %s\n",
                 options.channel.c_str(), channel_names().c_str());
    return bus::kExitUsage;
  }
  try {
    echo(*channel, options, field_url(options.lcm_url, options.config_path));
    return bus::kExitOk;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "orchard echo: %s\n", error.what());
    return bus::kExitRuntime;
  }
}

}  // namespace orchard::cli
