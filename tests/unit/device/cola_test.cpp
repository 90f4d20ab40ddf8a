// SPDX-License-Identifier: BSD-3-Clause
// CoLa-A against telegrams written by hand from SICK's telegram listing (8014631).
#include <gtest/gtest.h>

#include "device/cola/cola_fields.hpp"
#include "device/cola/cola_protocol.hpp"

namespace orchard::device {
namespace {

constexpr double kPi = 3.14159265358979323846;

TEST(ColaFields, NumbersOfEveryKind) {
  ColaFields fields("1F4 FFF92230 +100 -15 3F800000 40000000 text");
  EXPECT_EQ(fields.number(), 500u);
  EXPECT_EQ(fields.signed_number(), -450'000);
  EXPECT_EQ(fields.signed_number(), 100);
  EXPECT_EQ(fields.signed_number(), -15);
  EXPECT_EQ(fields.real(), 1.0f);
  EXPECT_EQ(fields.real(), 2.0f);
  EXPECT_EQ(fields.text(), "text");
  EXPECT_TRUE(fields.ok());
  fields.text();
  EXPECT_FALSE(fields.ok());
  EXPECT_FALSE(ColaFields("1G").ok() && ColaFields("1G").number() == 1);
}

TEST(ColaFields, WhatIsNoNumberEndsIt) {
  for (const char* text : {"", " 1", "1G", "123456789", "-1", "0x1", "1  2"}) {
    ColaFields fields(text);
    fields.number();
    fields.number();
    EXPECT_FALSE(fields.ok()) << text;
  }
}

TEST(ColaFields, AfterOneThatIsNoneEveryKindReadsNothing) {
  ColaFields fields("x +100");
  fields.number();
  EXPECT_EQ(fields.signed_number(), 0);
  EXPECT_EQ(fields.real(), 0.0f);
  EXPECT_EQ(fields.text(), "");
  EXPECT_FALSE(fields.ok());
}

/// Five beams from -45 degrees in steps of a third: 500, 0, 1000, 3, 65535 mm; 15 turns a second;
/// begun at 1,000,000 us and sent at 1,050,000 us of the device's clock.
const std::string kHead = "sSN LMDscandata 1 1 89A27F 0 0 1A 1B F4240 100590 0 0 3F 0 0 5DC 21C 0";
const std::string kDistances = "DIST1 3F800000 00000000 FFF92230 D05 5 1F4 0 3E8 3 FFFF";
const std::string kTail = " 0 0 0 0 0";

TEST(ColaScan, AnglesRangesAndTimesAreThoseOfTheTelegram) {
  const auto sweep =
      parse_cola_scan(kHead + " 1 " + kDistances + " 0" + kTail, cola_model("TiM561-2050101"), {});
  ASSERT_TRUE(sweep);
  EXPECT_EQ(sweep->num_sent, 26u);
  EXPECT_EQ(sweep->start_ticks, 1'000'000u);
  EXPECT_EQ(sweep->sent_ticks, 1'050'000u);
  EXPECT_FALSE(sweep->has_error);
  EXPECT_EQ(sweep->scan.ranges_m, (std::vector<float>{0.5f, 0.0f, 1.0f, 0.0f, 0.0f}));
  for (int i = 0; i < 5; ++i) {  // start and step in 1/10000 degree, 90 degrees is ahead
    const double angle_deg = (-450'000 + i * 3333) / 10'000.0 - 90.0;
    EXPECT_NEAR(sweep->scan.bearing_rad(i), angle_deg * kPi / 180.0, 1e-9);
  }
  EXPECT_NEAR(sweep->scan.beam_period_us, 1e6 / 15.0 * 0.3333 / 360.0, 1e-9);
  EXPECT_EQ(sweep->to_first_beam_us, 0.0);
}

TEST(ColaScan, TheEndsOfTheRangeTellTheStepWithoutItsRounding) {
  // -45 to -43.6667 degrees in four steps.
  const auto range = parse_cola_range("sRA LMPoutputRange 1 D05 FFF92230 FFF95645");
  ASSERT_TRUE(range);
  EXPECT_EQ(range->stop, -436'667);
  const auto sweep = parse_cola_scan(kHead + " 1 " + kDistances + " 0" + kTail, {}, range);
  ASSERT_TRUE(sweep);
  EXPECT_NEAR(sweep->scan.bearing_step_rad, 1.33330 / 4 * kPi / 180.0, 1e-9);
  EXPECT_NEAR(sweep->scan.bearing_rad(4), (-43.6667 - 90.0) * kPi / 180.0, 1e-9);
  // Ends that do not fit are not believed.
  const auto other = parse_cola_scan(kHead + " 1 " + kDistances + " 0" + kTail, {},
                                     ColaRange{-450'000, 2'250'000});
  EXPECT_NEAR(other->scan.bearing_step_rad, 0.3333 * kPi / 180.0, 1e-12);
}

TEST(ColaScan, AnOutputThatBeginsLaterHasItsFirstBeamLater) {
  // From 0 degrees (to the right): an eighth of a turn after the first shot.
  const std::string later = "DIST1 3F800000 00000000 0 D05 2 1F4 1F4";
  const auto sweep = parse_cola_scan(kHead + " 1 " + later + " 0" + kTail, {}, {});
  ASSERT_TRUE(sweep);
  EXPECT_NEAR(sweep->to_first_beam_us, 1e6 / 15.0 / 8.0, 1e-6);
}

TEST(ColaScan, TheScaleIsAFactor) {
  const std::string doubled = "DIST1 40000000 00000000 FFF92230 1388 2 1F4 2710";
  const auto sweep = parse_cola_scan(kHead + " 1 " + doubled + " 0" + kTail, {}, {});
  ASSERT_TRUE(sweep);
  EXPECT_EQ(sweep->scan.ranges_m, (std::vector<float>{1.0f, 20.0f}));
}

TEST(ColaScan, IntensitiesComeIn16AndIn8Bits) {
  const std::string rssi = "RSSI1 3F800000 00000000 FFF92230 D05 5 1 2 3 4 ";
  const auto wide =
      parse_cola_scan(kHead + " 2 " + kDistances + " " + rssi + "FFFF 0" + kTail, {}, {});
  ASSERT_TRUE(wide);
  EXPECT_EQ(wide->scan.intensities, (std::vector<float>{1, 2, 3, 4, 65535}));
  const auto narrow =
      parse_cola_scan(kHead + " 1 " + kDistances + " 1 " + rssi + "FF" + kTail, {}, {});
  ASSERT_TRUE(narrow);
  EXPECT_EQ(narrow->scan.intensities, (std::vector<float>{1, 2, 3, 4, 255}));
}

TEST(ColaScan, WhatIsCutOffAnywhereInTheDataIsRefused) {
  const std::string whole = kHead + " 1 " + kDistances + " 0";
  ASSERT_TRUE(parse_cola_scan(whole, {}, {}));
  for (std::size_t size = 0; size + 1 < whole.size(); ++size) {
    EXPECT_FALSE(parse_cola_scan(whole.substr(0, size), {}, {})) << whole.substr(0, size);
  }
}

TEST(ColaScan, HostileCountsAndAnglesAreRefused) {
  for (const char* channels :
       {"FFFFFFFF", "10", "1 DIST1 3F800000 00000000 0 D05 FFFFFFFF 1",
        "1 DIST1 7FC00000 0 0 D05 2 1 1", "1 DIST1 3F800000 0 0 0 2 1 1",
        "1 DIST1 3F800000 0 7FFFFFFF D05 2 1 1", "1 DIST1 3F800000 0 80000000 D05 2 1 1",
        "1 DIST1 3F800000 0 0 D05 1 1", "1 DIST1 3F800000 0 0 D05 2 1 10000",
        "1 RSSI1 3F800000 0 0 D05 2 1 1"}) {
    EXPECT_FALSE(parse_cola_scan(kHead + " " + channels + " 0" + kTail, {}, {})) << channels;
  }
}

std::string telegram(const std::string& text) { return "\x02" + text + "\x03"; }

std::string sent(ColaProtocol& cola) {
  std::string text = cola.take_to_send();
  if (text.size() < 2) return text;
  return text.substr(1, text.size() - 2);
}

TEST(ColaProtocol, AsksForIntensitiesWhereItMayLogIn) {
  ColaProtocol cola;
  cola.connected(0);
  EXPECT_EQ(sent(cola), "sEN LMDscandata 0");
  cola.receive(telegram(kHead + " 1 " + kDistances + " 0" + kTail), 0);  // of an earlier talk
  EXPECT_TRUE(cola.take_measurements().empty());
  cola.receive(telegram("sEA LMDscandata 0"), 0);
  EXPECT_EQ(sent(cola), "sRN DeviceIdent");
  cola.receive(telegram("sRA DeviceIdent E TiM561-2050101 6 V2.5.0"), 0);
  EXPECT_EQ(sent(cola), "sRN LMPoutputRange");
  cola.receive(telegram("sRA LMPoutputRange 1 D05 FFF92230 225510"), 0);
  EXPECT_EQ(sent(cola), "sMN SetAccessMode 03 F4724744");
  cola.receive(telegram("sAN SetAccessMode 1"), 0);
  EXPECT_EQ(sent(cola), "sWN LMDscandatacfg 01 00 1 1 0 00 00 0 0 0 0 +1");
  cola.receive(telegram("sWA LMDscandatacfg"), 0);
  EXPECT_EQ(sent(cola), "sMN Run");
  cola.receive(telegram("sAN Run 1"), 0);
  EXPECT_EQ(sent(cola), "sEN LMDscandata 1");
  cola.receive(telegram("sEA LMDscandata 1"), 0);
  EXPECT_EQ(cola.condition(), "waits for the scanner's first scan");
  // Sent 50 ms after it began, and read 100 us after it was sent: nothing is known to be quicker.
  cola.receive(telegram(kHead + " 1 " + kDistances + " 0" + kTail), 2'000'000);
  const auto measured = cola.take_measurements();
  ASSERT_EQ(measured.size(), 1u);
  EXPECT_NEAR(static_cast<double>(std::get<laser::Scan>(measured[0]).utime), 1'950'000.0, 2.0);
  EXPECT_EQ(std::get<laser::Scan>(measured[0]).range_max_m, 10.0);
  EXPECT_EQ(cola.condition(), "");
  EXPECT_EQ(cola.counts().num_bad, 0);
}

TEST(ColaProtocol, GoesOnWhereItMayNot) {
  ColaProtocol cola;
  cola.connected(0);
  cola.receive(telegram("sEA LMDscandata 0"), 0);
  cola.receive(telegram("sFA 3"), 0);  // no DeviceIdent
  cola.receive(telegram("sFA 3"), 0);  // no LMPoutputRange
  cola.take_to_send();
  cola.receive(telegram("sAN SetAccessMode 0"), 0);
  EXPECT_EQ(sent(cola), "sEN LMDscandata 1");
}

TEST(ColaProtocol, ASweepThatOvertakesTheAnswerIsOne) {
  ColaProtocol cola;
  cola.connected(0);
  for (const char* answer : {"sEA LMDscandata 0", "sFA 3", "sFA 3", "sFA 3"}) {
    cola.receive(telegram(answer), 0);
  }
  cola.expire(*cola.deadline());
  EXPECT_EQ(cola.condition(), "waits for the scanner's answer to sEN LMDscandata 1");
  cola.receive(telegram(kHead + " 1 " + kDistances + " 0" + kTail), 1'000'000);
  EXPECT_EQ(cola.take_measurements().size(), 1u);
  EXPECT_EQ(cola.condition(), "");
}

TEST(ColaProtocol, ADeviceInTroubleSaysSo) {
  ColaProtocol cola;
  cola.connected(0);
  for (const char* answer : {"sEA LMDscandata 0", "sFA 3", "sFA 3", "sFA 3", "sEA LMDscandata 1"}) {
    cola.receive(telegram(answer), 0);
  }
  std::string dirty = kHead + " 1 " + kDistances + " 0" + kTail;
  dirty.replace(dirty.find(" 0 0 1A"), 7, " 0 2 1A");
  cola.receive(telegram(dirty), 0);
  EXPECT_EQ(cola.take_measurements().size(), 1u);
  EXPECT_EQ(cola.condition(), "the scanner reports a dirty front screen; clean it");
  dirty.replace(dirty.find(" 0 2 1A"), 7, " 0 1 1A");
  cola.receive(telegram(dirty), 0);
  EXPECT_TRUE(cola.take_measurements().empty());
  EXPECT_EQ(cola.counts().num_bad, 1);
  EXPECT_NE(cola.condition(), "");
}

TEST(ColaProtocol, HalfATelegramIsForgottenAtTheNextStart) {
  ColaProtocol cola;
  cola.connected(0);
  cola.take_to_send();
  cola.receive("\x02sEA LMD\x02sEA LMDscandata 0\x03", 0);
  EXPECT_EQ(sent(cola), "sRN DeviceIdent");
}

}  // namespace
}  // namespace orchard::device
