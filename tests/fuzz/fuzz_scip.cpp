// SPDX-License-Identifier: BSD-3-Clause
//
// Any bytes of a Hokuyo scanner. The first byte chooses how they are cut into pieces.
#include "device/scip/scip_protocol.hpp"
#include "fuzz/fuzz_protocol.hpp"
#include "fuzz/fuzz_seeds.hpp"

using namespace orchard;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  device::ScipProtocol protocol;
  fuzz::feed(protocol, {reinterpret_cast<const char*>(data) + 1, size - 1}, data[0]);
  return 0;
}

namespace orchard::fuzz {

std::vector<std::string> seeds() {
  const std::string parameters =
      "PP\n00P\nMODL:URG-04LX(Hokuyo Automatic Co.,Ltd.);N\nDMIN:20;4\nDMAX:5600;_\nARES:16;<\n"
      "AMIN:2;A\nAMAX:5;F\nAFRT:4;K\nSCAN:600;e\n\n";
  const std::string short_range =
      "PP\n00P\nDMIN:20;4\nDMAX:4095;f\nARES:16;<\nAMIN:2;A\nAMAX:5;F\nAFRT:4;K\nSCAN:600;e\n\n";
  std::string readings;
  for (int i = 0; i < 12; ++i) readings += "TM1\n00P\nm2@0?\n\n";
  const std::string clock = "TM0\n00P\n\n" + readings + "TM2\n00P\n\n";
  const std::string sweep = "MD0002000500000\n99b\nm2@0?\n0CB1Dh00C1GQn\n\n";
  const std::string both = "ME0002000500000\n99b\nm2@0?\n0CB03h1Dh00200C0001GQ000k\n\n";
  const std::string two = "MS0002000500000\n99b\nm2@0?\nCBoo0CP0F\n\n";
  return {"\x10QT\n00P\n\n" + parameters + "II\n00P\nSCSP:Initial(540[rpm]);^\n\n" + clock +
              "BM\n00P\n\nME0002000500000\n0Ee\n\nMD0002000500000\n00P\n\n" + sweep + sweep,
          "\x21QT\n00P\n\n" + parameters +
              "II\n0Ee\n\nTM0\n0Ee\n\nBM\n02R\n\n"
              "ME0002000500000\n00P\n\n" +
              both + both,
          "\x3dQT\n00P\n\n" + short_range +
              "II\n0Ee\n\nTM0\n0Ee\n\nBM\n00P\n\n"
              "MS0002000500000\n00P\n\n" +
              two + "MS0002000500000\n50U\n\n"};
}

}  // namespace orchard::fuzz
