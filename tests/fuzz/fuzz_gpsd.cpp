// SPDX-License-Identifier: BSD-3-Clause
//
// Any bytes of gpsd. The first byte chooses how they are cut into pieces.
#include "device/gnss/gpsd_protocol.hpp"
#include "fuzz/fuzz_protocol.hpp"
#include "fuzz/fuzz_seeds.hpp"

using namespace orchard;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  device::GnssDriverConfig config;
  config.stamp = data[0] % 2 == 0 ? device::GnssStamp::kReceipt : device::GnssStamp::kFixTime;
  device::GpsdProtocol protocol(config);
  fuzz::feed(protocol, {reinterpret_cast<const char*>(data) + 1, size - 1}, data[0]);
  return 0;
}

namespace orchard::fuzz {

std::vector<std::string> seeds() {
  const std::string fix =
      R"({"class":"TPV","device":"/dev/ttyACM0","status":3,"mode":3,)"
      R"("time":"2026-05-04T10:11:12.250Z","lat":-32.4,"lon":-71.3,"altHAE":51.5,)"
      R"("eph":0.02,"epx":1.5,"epy":1.6,"epv":2.0})";
  const std::string later =
      R"({"class":"TPV","device":"/dev/ttyACM0","mode":2,"time":"2026-05-04T10:11:13Z",)"
      R"("lat":-32.4,"lon":-71.3})";
  const std::string noise =
      R"({"class":"GST","device":"/dev/ttyACM0","time":"2026-05-04T10:11:12.250Z","major":0.03,)"
      R"("minor":0.01,"orient":30.0,"lat":0.02,"lon":0.025,"alt":0.05})";
  return {"\x10{\"class\":\"VERSION\",\"release\":\"3.22\"}\r\n" + fix + "\r\n" + noise + "\r\n" +
              later + "\r\n",
          "\x11" + noise + "\r\n" + fix + "\r\n" + later + "\r\n",
          "\x30{\"class\":\"DEVICES\",\"devices\":[{\"path\":\"a\"}]}\n"
          "{\"class\":\"ERROR\",\"message\":\"no\"}\n{\"class\":\"TPV\",\"mode\":1}\n"};
}

}  // namespace orchard::fuzz
