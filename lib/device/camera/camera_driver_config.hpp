// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::device {

/// The camera of orchard-camera-driver; section `camera` gives the size of its pictures. Section
/// `drivers.camera`.
struct CameraDriverConfig {
  std::string device;
  double rate_hz = 10.0;
  int max_bytes = 60000;
};

template <class Visitor>
void describe(Visitor& v, CameraDriverConfig& c) {
  v.text("device", c.device,
         "camera: /dev/video0, pictures:FOLDER or video:FILE; empty = no camera");
  v.number("rate_hz", c.rate_hz, 0.1, 120, "Hz", "max pictures per second");
  v.expert().integer(
      "max_bytes", c.max_bytes, 1000, 4000000, "bytes",
      "max size of a picture; larger ones are compressed again; above 60000 a picture needs "
      "several datagrams");
}

}  // namespace orchard::device
