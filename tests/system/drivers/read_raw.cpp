// SPDX-License-Identifier: BSD-3-Clause
//
// read_raw PROTOCOL FILE: what a protocol (scip, cola, gpsd) makes of recorded bytes (the format of
// io/recording/raw_bytes.hpp), a line per measurement:
//   scan UTIME BEARING_MIN STEP BEAM_PERIOD_US RANGE_MIN RANGE_MAX NUM range ... intensity ...
//   gnss UTIME LATITUDE LONGITUDE ALTITUDE QUALITY ee en eu nn nu uu
// and at the end "counts GOOD BAD" and "condition LEVEL TEXT".
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <string>

#include "bus/driver/source.hpp"
#include "device/gnss/gpsd_protocol.hpp"
#include "device/laser_protocol.hpp"

namespace orchard {
namespace {

std::unique_ptr<device::Protocol> make_protocol(const std::string& name) {
  if (name == "gpsd") return std::make_unique<device::GpsdProtocol>(device::GnssDriverConfig{});
  device::LaserDriverConfig config;
  if (name == "cola") config.protocol = device::LaserProtocol::kCola;
  return device::make_laser_protocol(config);
}

void print(const laser::Scan& scan) {
  std::printf("scan %lld %.12g %.12g %.9g %.9g %.9g %zu", static_cast<long long>(scan.utime),
              scan.bearing_min_rad, scan.bearing_step_rad, scan.beam_period_us,
              static_cast<double>(scan.range_min_m), static_cast<double>(scan.range_max_m),
              scan.ranges_m.size());
  for (const auto* values : {&scan.ranges_m, &scan.intensities}) {
    for (const float value : *values) std::printf(" %.9g", static_cast<double>(value));
  }
  std::printf("\n");
}

void print(const pose::Gnss& gnss) {
  std::printf("gnss %lld %.12g %.12g %.9g %d", static_cast<long long>(gnss.utime),
              gnss.latitude_deg, gnss.longitude_deg, gnss.altitude_m, gnss.fix_quality);
  for (const double value : gnss.covariance) std::printf(" %.9g", value);
  std::printf("\n");
}

void read(const std::string& protocol_name, const std::string& path) {
  auto protocol = make_protocol(protocol_name);
  const device::Protocol& said = *protocol;
  bus::RawSource source(std::move(protocol), path);
  while (const auto message = source.next()) {
    if (const auto* scan = std::get_if<laser::Scan>(&*message)) print(*scan);
    if (const auto* gnss = std::get_if<pose::Gnss>(&*message)) print(*gnss);
  }
  const device::Condition condition = said.condition();
  std::printf("counts %lld %lld\ncondition %d %s\n", static_cast<long long>(said.counts().num_good),
              static_cast<long long>(said.counts().num_bad), static_cast<int>(condition.severity),
              condition.text.c_str());
}

}  // namespace
}  // namespace orchard

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  try {
    orchard::read(argv[1], argv[2]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
