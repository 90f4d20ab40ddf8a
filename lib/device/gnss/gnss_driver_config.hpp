// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::device {

/// Source of a fix's time stamp.
enum class GnssStamp {
  kReceipt,  ///< its arrival, freed of jitter, minus latency_s
  kFixTime,  ///< its own time; correct where satellite time sets the host's clock (chrony with the
             ///< receiver)
};

/// The receiver of orchard-gnss-driver, read through gpsd. Section `drivers.gnss`.
struct GnssDriverConfig {
  std::string device;    ///< empty: no receiver
  std::string receiver;  ///< gpsd's name of the receiver; empty: the first that reports
  GnssStamp stamp = GnssStamp::kReceipt;
  double latency_s = 0.1;  ///< min delay from the instant of a fix to its arrival
};

template <class Visitor>
void describe(Visitor& v, GnssDriverConfig& c) {
  v.text("device", c.device, "where gpsd listens: tcp:127.0.0.1:2947; empty: no receiver");
  v.text("receiver", c.receiver, "as gpsd names it (/dev/ttyACM0); empty: the first that reports");
  v.choice("stamp", c.stamp, {"receipt", "fix_time"},
           "stamps from arrival less latency_s | the fix's own time, where the host keeps it, too");
  v.number("latency_s", c.latency_s, 0, 2, "s",
           "stamp: receipt: from the instant of a fix to its quickest arrival");
}

}  // namespace orchard::device
