// SPDX-License-Identifier: BSD-3-Clause
//
// Any bytes of a robot's controller. The first byte chooses how they are cut into pieces.
#include "device/lines/controller_protocol.hpp"
#include "fuzz/fuzz_protocol.hpp"
#include "fuzz/fuzz_seeds.hpp"

using namespace orchard;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  device::OdometryDriverConfig odometry;
  odometry.counter_bits = 8 + data[0] % 57;
  device::ControllerProtocol protocol(odometry, device::ImuDriverConfig{});
  fuzz::feed(protocol, {reinterpret_cast<const char*>(data) + 1, size - 1}, data[0]);
  return 0;
}

namespace orchard::fuzz {

std::vector<std::string> seeds() {
  return {"\x01 half\nV 0.5 0.1\nV 0.6 0.1 0.01 0.02\nV,1,2 @17\n",
          "\x20\nT 100 200 @1000000\nT 110 210 @1020000\nT -1 -5 @4294967290\nT 4 0 @12\n",
          "\x31\nI 0 0 0 0 0 9.8\nI 0 0 0 0 0 9.8 1 1 3 @5\n# comment\n",
          "\x40\nV 0.52 -0.013 @1500000*1A\nV 1 0\n\r\n*00\n@5\n"};
}

}  // namespace orchard::fuzz
