// SPDX-License-Identifier: BSD-3-Clause
#include "cli/logs/simulated_rig.hpp"

#include <cinttypes>
#include <cstdio>

#include "bus/messages/codec.hpp"
#include "bus/messages/service_messages.hpp"
#include "cli/interruptible_work.hpp"
#include "io/config/config.hpp"
#include "io/log/log_writer.hpp"

namespace orchard::cli {

io::Config rig_of(const SimulateOptions& options) {
  return options.config_path.empty() ? io::scene_rig(options.scene)
                                     : io::load_config(options.config_path);
}

void write_simulated_log(const SimulateOptions& options, const io::Config& config,
                         std::int64_t begin_utime, std::int64_t end_utime,
                         const std::function<std::optional<bus::Message>()>& next) {
  InterruptibleWork work("simulating");
  io::LogWriter writer(options.out_path);
  std::int64_t num_messages = 0, last_utime = begin_utime;
  while (const auto message = next()) {
    const std::int64_t utime = bus::utime_of(*message);
    if (options.duration_s > 0.0 && utime > end_utime) break;
    if (utime < begin_utime) continue;
    if (num_messages == 0) {
      bus::ConfigNotice notice;
      notice.utime = utime;
      notice.hash = io::config_hash(config);
      notice.name = "orchard-simulate";
      notice.version = ORCHARD_VERSION;
      notice.text = io::effective_config(config);
      writer.write(utime, bus::info(bus::Channel::kConfig).name, bus::encode(notice));
      ++num_messages;
    }
    writer.write(utime, bus::info(bus::channel_of(*message)).name, bus::encode(*message));
    ++num_messages;
    last_utime = utime;
    work.update(static_cast<std::uint64_t>(utime - begin_utime),
                static_cast<std::uint64_t>(end_utime - begin_utime));
  }
  work.finish();
  writer.close();
  std::printf("%s: %" PRId64 " messages, %.1f s of scene %s, seed %" PRIu64 "\n",
              options.out_path.c_str(), num_messages,
              static_cast<double>(last_utime - begin_utime) * 1e-6, options.scene.c_str(),
              options.seed);
}

}  // namespace orchard::cli
