// SPDX-License-Identifier: BSD-3-Clause
//
// Any bytes of a device. The first byte chooses the device and its settings, the second how the
// bytes are cut into pieces.
#include <algorithm>
#include <cstdlib>
#include <map>
#include <memory>
#include <string_view>
#include <utility>
#include <variant>

#include "bus/messages/codec.hpp"
#include "device/cola/cola_protocol.hpp"
#include "device/cola/cola_telegram.hpp"
#include "device/gnss/gpsd_protocol.hpp"
#include "device/lines/controller_protocol.hpp"
#include "device/scip/scip_protocol.hpp"
#include "device/velodyne/velodyne_protocol.hpp"
#include "fuzz/fuzz_seeds.hpp"

namespace orchard::fuzz {
namespace {

/// Hands bytes to a protocol in pieces whose sizes follow from `pieces`, or in datagrams, and asks
/// and expires in between. What it measures passes the guard of the bus and comes with rising
/// stamps per channel.
void feed(device::Protocol& protocol, std::string_view bytes, std::uint8_t pieces) {
  const bool is_udp = dynamic_cast<device::VelodyneProtocol*>(&protocol) != nullptr;
  std::int64_t host_utime = 1'700'000'000'000'000;
  std::map<bus::Channel, std::int64_t> last_utime;
  protocol.connected(host_utime);
  for (std::size_t i = 0; !bytes.empty(); ++i) {
    const std::size_t size =
        is_udp ? device::VelodynePacket::kNumBytes : 1 + (pieces * (i + 7)) % 61;
    host_utime += 3000;
    protocol.receive(bytes.substr(0, size), host_utime);
    bytes.remove_prefix(std::min(size, bytes.size()));
    if (i % 16 == 5 && protocol.deadline()) {
      host_utime = std::max(host_utime, *protocol.deadline());
      protocol.expire(host_utime);
    }
    if (!protocol.failure().empty()) protocol.connected(host_utime);
    protocol.condition();
    protocol.take_to_send();
    for (const device::Measurement& measurement : protocol.take_measurements()) {
      const bus::Message message =
          std::visit([](const auto& m) { return bus::Message(m); }, measurement);
      const bus::Channel channel = bus::channel_of(message);
      const std::vector<std::uint8_t> encoded = bus::encode(message);
      const auto decoded = bus::decode(channel, encoded.data(), encoded.size());
      if (std::holds_alternative<bus::Rejection>(decoded)) std::abort();
      const std::int64_t utime = bus::utime_of(message);
      if (last_utime.count(channel) != 0 && utime <= last_utime[channel]) std::abort();
      last_utime[channel] = utime;
    }
    // Last, as a driver does it: what was measured before the step has been taken.
    if (i % 64 == 63) {
      const std::int64_t step_us = i % 128 == 63 ? 3'600'000'000 : -3'600'000'000;
      host_utime += step_us;
      protocol.host_clock_stepped(step_us);
      last_utime.clear();
    }
  }
}

std::unique_ptr<device::Protocol> make_protocol(std::uint8_t choice) {
  switch (choice % 5) {
    case 0:
      return std::make_unique<device::ScipProtocol>();
    case 1:
      return std::make_unique<device::ColaProtocol>();
    case 2: {
      device::GnssDriverConfig config;
      config.stamp = choice % 8 < 4 ? device::GnssStamp::kReceipt : device::GnssStamp::kFixTime;
      return std::make_unique<device::GpsdProtocol>(config);
    }
    case 4:
      return std::make_unique<device::VelodyneProtocol>(
          device::VelodyneMount{0.1 * (1 + choice % 30)});
    default: {
      device::OdometryDriverConfig odometry;
      odometry.counter_bits = 8 + choice % 57;
      return std::make_unique<device::ControllerProtocol>(odometry, device::ImuDriverConfig{});
    }
  }
}

std::vector<std::string> scip_seeds() {
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

std::vector<std::string> cola_seeds() {
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

/// A binary telegram in its frame, whose content is given in hexadecimal digits after its name.
std::string binary_telegram(const std::string& name, const std::string& digits) {
  std::string content = name;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2) {
    content += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
  }
  return device::framed(device::ColaDialect::kB, content);
}

std::vector<std::string> binary_cola_seeds() {
  const std::string head =
      "000100010089a27f0000001a001b000f42400010059000003f000000000005dc0000021c0000";
  const std::string distances = "44495354313f80000000000000fff922300d05000501f4000003e80003ffff";
  const std::string rssi = "52535349313f80000000000000fff922300d0500050001000200030004";
  // Small pieces come before the first deadline: the second request is answered.
  const std::string granted =
      std::string(200, ' ') + binary_telegram("sEA LMDscandata ", "00") +
      binary_telegram("sRA DeviceIdent ", "000454694d35000156") +
      binary_telegram("sRA LMPoutputRange ", "000100000d05fff92230fff95645") +
      binary_telegram("sAN SetAccessMode ", "01") + binary_telegram("sWA LMDscandatacfg ", "") +
      binary_telegram("sAN Run ", "01") + binary_telegram("sEA LMDscandata ", "01");
  const std::string sweep = "sSN LMDscandata ";
  return {"\x10" + granted + binary_telegram(sweep, head + "0001" + distances + "0000"),
          "\x25" + granted + binary_telegram(sweep, head + "0002" + distances + rssi + "00ff0000") +
              binary_telegram("sFA ", "0005"),
          "\x33" + granted + binary_telegram(sweep, head + "0001" + distances + "0001" + rssi)};
}

std::vector<std::string> gpsd_seeds() {
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

std::vector<std::string> lines_seeds() {
  return {"\x01 half\nV 0.5 0.1\nV 0.6 0.1 0.01 0.02\nV,1,2 @17\n",
          "\x20\nT 100 200 @1000000\nT 110 210 @1020000\nT -1 -5 @4294967290\nT 4 0 @12\n",
          "\x31\nI 0 0 0 0 0 9.8\nI 0 0 0 0 0 9.8 1 1 3 @5\n# comment\n",
          "\x40\nV 0.52 -0.013 @1500000*1A\nV 1 0\n\r\n*00\n@5\n"};
}

/// A turn and a bit of a VLP-16, which sees nothing.
std::vector<std::string> velodyne_seeds() {
  std::string packets = "\x01";
  const auto put_two = [&packets](unsigned value) {
    packets += static_cast<char>(value & 0xffu);
    packets += static_cast<char>(value >> 8 & 0xffu);
  };
  for (unsigned packet = 0; packet < 180; ++packet) {
    for (unsigned block = 0; block < 12; ++block) {
      put_two(0xeeff);
      put_two((packet * 12 + block) * 40 % 36000);
      packets.append(96, '\0');
    }
    const unsigned stamp_us = packet * 13271 / 10;
    put_two(stamp_us & 0xffffu);
    put_two(stamp_us >> 16);
    packets += "7\x22";
  }
  return {packets};
}

}  // namespace

std::vector<std::string> seeds() {
  std::vector<std::string> all;
  char choice = 0;
  for (const auto& seeds_of :
       {scip_seeds(), cola_seeds(), gpsd_seeds(), lines_seeds(), velodyne_seeds()}) {
    for (const std::string& seed : seeds_of) all.push_back(choice + seed);
    ++choice;
  }
  for (const std::string& seed : binary_cola_seeds()) all.push_back('\1' + seed);
  return all;
}

}  // namespace orchard::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const auto protocol = orchard::fuzz::make_protocol(data[0]);
  orchard::fuzz::feed(*protocol, {reinterpret_cast<const char*>(data) + 2, size - 2}, data[1]);
  return 0;
}
