// SPDX-License-Identifier: BSD-3-Clause
#include "io/log/log_repair.hpp"

#include <filesystem>

#include "io/file_error.hpp"
#include "io/log/log_writer.hpp"

namespace orchard::io {

LogRepair repair_log(const std::string& path, const std::string& out_path,
                     const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  std::error_code ignored;
  if (std::filesystem::equivalent(path, out_path, ignored)) {
    throw FileError(out_path + " is the input log; give another name for the output");
  }
  LogReader reader(path);  // opened before the output is created
  LogWriter writer(out_path);
  LogRepair repair;
  while (const auto event = reader.next()) {
    writer.write(event->timestamp_us, event->channel, event->data);
    ++repair.num_events;
    if (progress) progress(reader.position(), reader.file_size());
  }
  if (repair.num_events == 0) {
    throw FileError(path + " has no readable LCM event; give an LCM log");
  }
  repair.gaps = reader.gaps();
  for (const LogGap& gap : repair.gaps) repair.num_lost_bytes += gap.size;
  writer.close();
  return repair;
}

}  // namespace orchard::io
