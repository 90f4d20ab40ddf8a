// SPDX-License-Identifier: BSD-3-Clause
#include "cli/logs/imported_log.hpp"

#include <cinttypes>
#include <cstdio>

#include "bus/messages/codec.hpp"
#include "cli/interruptible_work.hpp"
#include "cli/parent_folder.hpp"
#include "io/log/log_writer.hpp"

namespace orchard::cli {

Imported write_imported(const NextMessage& next, std::uint64_t num_all,
                        const std::string& out_path) {
  make_parent_folder(out_path);
  InterruptibleWork work("importing messages");
  io::LogWriter writer(out_path);
  Imported imported;
  while (const auto message = next()) {
    const bus::Channel channel = bus::channel_of(*message);
    const std::int64_t utime = bus::utime_of(*message);
    writer.write(utime, bus::info(channel).name, bus::encode(*message));
    if (imported.num_all++ == 0) imported.first_utime = utime;
    imported.last_utime = utime;
    ++imported.num_messages[static_cast<std::size_t>(channel)];
    work.update(static_cast<std::uint64_t>(imported.num_all), num_all);
  }
  work.finish();
  writer.close();
  return imported;
}

void print_imported(const std::string& out_path, const Imported& imported) {
  std::printf("%s: %" PRId64 " messages over %.1f s:", out_path.c_str(), imported.num_all,
              1e-6 * static_cast<double>(imported.last_utime - imported.first_utime));
  for (const bus::ChannelInfo& channel : bus::kChannels) {
    const std::int64_t num = imported.num_messages[static_cast<std::size_t>(channel.channel)];
    if (num > 0) std::printf(" %" PRId64 " %s", num, std::string(channel.name).c_str());
  }
  std::printf("\n");
}

void print_ignored(const std::map<std::string, std::int64_t>& ignored) {
  for (const auto& [what, num] : ignored) {
    std::printf("not used: %" PRId64 " x %s\n", num, what.c_str());
  }
}

}  // namespace orchard::cli
