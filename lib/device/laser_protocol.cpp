// SPDX-License-Identifier: BSD-3-Clause
#include "device/laser_protocol.hpp"

#include <stdexcept>

#include "device/cola/cola_protocol.hpp"
#include "device/scip/scip_protocol.hpp"

namespace orchard::device {

namespace {

std::unique_ptr<ScannerSession> make_session(LaserProtocol protocol) {
  switch (protocol) {
    case LaserProtocol::kScip:
      return std::make_unique<ScipProtocol>();
    case LaserProtocol::kCola:
      return std::make_unique<ColaProtocol>();
  }
  throw std::invalid_argument("unknown scanner protocol");
}

}  // namespace

std::unique_ptr<Protocol> make_laser_protocol(const LaserDriverConfig& config) {
  auto session = make_session(config.protocol);
  session->set_delay(config.delay_s);
  return session;
}

}  // namespace orchard::device
