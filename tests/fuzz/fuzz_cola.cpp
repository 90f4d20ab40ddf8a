// SPDX-License-Identifier: BSD-3-Clause
//
// Any bytes of a SICK scanner. The first byte chooses how they are cut into pieces.
#include "device/cola/cola_protocol.hpp"
#include "fuzz/fuzz_protocol.hpp"
#include "fuzz/fuzz_seeds.hpp"

using namespace orchard;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  device::ColaProtocol protocol;
  fuzz::feed(protocol, {reinterpret_cast<const char*>(data) + 1, size - 1}, data[0]);
  return 0;
}

namespace orchard::fuzz {

std::vector<std::string> seeds() {
  const auto telegram = [](const std::string& text) { return "\x02" + text + "\x03"; };
  const std::string head =
      "sSN LMDscandata 1 1 89A27F 0 0 1A 1B F4240 100590 0 0 3F 0 0 5DC 21C 0 ";
  const std::string distances = "DIST1 3F800000 00000000 FFF92230 D05 5 1F4 0 3E8 3 FFFF ";
  const std::string rssi = "RSSI1 3F800000 00000000 FFF92230 D05 5 1 2 3 4 FF ";
  const std::string granted =
      telegram("sEA LMDscandata 0") + telegram("sRA DeviceIdent E TiM561-2050101 6 V2.5.0") +
      telegram("sRA LMPoutputRange 1 D05 FFF92230 FFF95645") + telegram("sAN SetAccessMode 1") +
      telegram("sWA LMDscandatacfg") + telegram("sAN Run 1") + telegram("sEA LMDscandata 1");
  const std::string refused = telegram("sEA LMDscandata 0") + telegram("sFA 3") +
                              telegram("sFA 3") + telegram("sAN SetAccessMode 0") +
                              telegram("sEA LMDscandata 1");
  return {"\x10" + granted + telegram(head + "2 " + distances + rssi + "0 0 0 0 0 0"),
          "\x25" + refused + telegram(head + "1 " + distances + "1 " + rssi + "0 0 0 0 0"),
          "\x33" + refused + telegram(head + "1 " + distances + "0 0 0 0 0 0") + telegram("sFA 5")};
}

}  // namespace orchard::fuzz
