// SPDX-License-Identifier: BSD-3-Clause
#include "device/laser_protocol.hpp"

#include <stdexcept>

#include "device/cola/cola_protocol.hpp"
#include "device/scip/scip_protocol.hpp"
#include "device/velodyne/velodyne_protocol.hpp"

namespace orchard::device {

namespace {

std::unique_ptr<ScannerSession> make_session(const LaserDriverConfig& config,
                                             double plane_height_m) {
  VelodyneMount mount;
  mount.scanner_height_m = config.scanner_height_m;
  if (plane_height_m > 0.0) mount.plane_height_m = plane_height_m;
  switch (config.protocol) {
    case LaserProtocol::kScip:
      return std::make_unique<ScipProtocol>();
    case LaserProtocol::kCola:
      return std::make_unique<ColaProtocol>();
    case LaserProtocol::kVelodyne:
      return std::make_unique<VelodyneProtocol>(mount);
  }
  throw std::invalid_argument("unknown scanner protocol");
}

}  // namespace

std::unique_ptr<Protocol> make_laser_protocol(const LaserDriverConfig& config,
                                              double plane_height_m) {
  auto session = make_session(config, plane_height_m);
  session->set_delay(config.delay_s);
  return session;
}

}  // namespace orchard::device
