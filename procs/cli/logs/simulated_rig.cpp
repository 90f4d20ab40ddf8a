// SPDX-License-Identifier: BSD-3-Clause
#include "cli/logs/simulated_rig.hpp"

#include "bus/messages/codec.hpp"
#include "bus/messages/service_messages.hpp"
#include "io/config/config.hpp"

namespace orchard::cli {

io::Config rig_of(const SimulateOptions& options) {
  return options.config_path.empty() ? io::scene_rig(options.scene)
                                     : io::load_config(options.config_path);
}

void write_rig(io::LogWriter& writer, const io::Config& config, std::int64_t utime) {
  bus::ConfigNotice notice;
  notice.utime = utime;
  notice.hash = io::config_hash(config);
  notice.name = "orchard-simulate";
  notice.version = ORCHARD_VERSION;
  notice.text = io::effective_config(config);
  writer.write(utime, bus::info(bus::Channel::kConfig).name, bus::encode(notice));
}

}  // namespace orchard::cli
