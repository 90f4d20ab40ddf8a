// SPDX-License-Identifier: BSD-3-Clause
#include "cli/maps/scan_timer.hpp"

#include <fmt/core.h>
#include <cstdio>
#include <fstream>

namespace orchard::cli {
namespace {

constexpr std::int64_t kStretch = 1000;

/// Peak memory of this process [MiB]; 0 where the system does not report it.
double peak_mib() {
  std::ifstream status("/proc/self/status");
  std::string line;
  while (std::getline(status, line)) {
    double kib = 0.0;
    if (std::sscanf(line.c_str(), "VmHWM: %lf kB", &kib) == 1) return kib / 1024.0;
  }
  return 0.0;
}

}  // namespace

void ScanTimer::count() {
  if (++num_scans_ % kStretch != 0) return;
  const std::clock_t now = std::clock();
  stretches_.push_back({num_scans_ - kStretch + 1, num_scans_,
                        1e3 * static_cast<double>(now - begin_) / CLOCKS_PER_SEC / kStretch,
                        peak_mib()});
  begin_ = now;
}

std::string ScanTimer::text() const {
  std::string text;
  for (const Stretch& s : stretches_) {
    text += fmt::format("timing: scans {}-{}: {:.3f} ms a scan, {:.1f} MiB at most\n", s.first,
                        s.last, s.ms_per_scan, s.peak_mib);
  }
  return text + fmt::format("timing: in all: {:.1f} MiB at most\n", peak_mib());
}

}  // namespace orchard::cli
