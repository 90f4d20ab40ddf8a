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
  std::string device;
  std::string receiver;
  GnssStamp stamp = GnssStamp::kReceipt;
  double latency_s = 0.1;
};

template <class Visitor>
void describe(Visitor& v, GnssDriverConfig& c) {
  v.text("device", c.device, "address of gpsd: tcp:127.0.0.1:2947; empty = no receiver");
  v.expert().text("receiver", c.receiver,
                  "name of the receiver in gpsd (/dev/ttyACM0); empty = the first that reports");
  v.expert().choice(
      "stamp", c.stamp, {"receipt", "fix_time"},
      "time stamp: arrival minus latency_s | time of the fix, if the clock of this machine is "
      "synchronised to satellite time");
  v.expert().number("latency_s", c.latency_s, 0, 2, "s",
                    "stamp: receipt: min delay from a fix to its arrival; from the data sheet");
}

}  // namespace orchard::device
