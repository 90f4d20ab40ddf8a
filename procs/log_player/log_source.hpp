// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "bus/driver/source.hpp"
#include "bus/replay/replay_index.hpp"
#include "io/log/log_reader.hpp"

namespace orchard::procs {

/// Source of the sensor messages of a log, in replay order.
class LogSource : public bus::Source {
 public:
  /// Throws io::FileError as bus::index_log does.
  LogSource(const std::string& log_path, const bus::ReplayOptions& options);

  std::optional<bus::Message> next() override;
  std::optional<double> duration_s() const override {
    return 1e-6 * static_cast<double>(index_.report.last_utime - index_.report.first_utime);
  }
  const bus::ReplayReport& report() const { return index_.report; }

 private:
  bus::ReplayIndex index_;
  bus::ReplayEntries::Iterator next_;
  io::LogReader reader_;
};

}  // namespace orchard::procs
