// SPDX-License-Identifier: BSD-3-Clause
// SCIP 2.0 against frames encoded by hand from its specification, C-42-03320B, and CoLa-A against
// telegrams written by hand from SICK's telegram listing (8014631).
#include <gtest/gtest.h>

#include "device/cola/cola_protocol.hpp"
#include "device/scip/scip_protocol.hpp"

namespace orchard::device {
namespace {

constexpr double kPi = 3.14159265358979323846;

// The specification's own examples (section 6): 1234 mm, 5432 mm, 16,000,000 ms.
TEST(ScipText, NumbersAreThoseOfTheSpecification) {
  EXPECT_EQ(scip_number("CB"), 1234u);
  EXPECT_EQ(scip_number("1Dh"), 5432u);
  EXPECT_EQ(scip_number("m2@0"), 16'000'000u);
  EXPECT_EQ(scip_number("/0"), std::nullopt);  // 2fh and 70h are just outside
  EXPECT_EQ(scip_number("0p"), std::nullopt);
  EXPECT_EQ(scip_number(""), std::nullopt);
}

TEST(ScipText, SumsAreThoseOfTheSpecification) {
  EXPECT_EQ(scip_sum("Hokuyo"), 'o');
  EXPECT_EQ(checked_line("00P"), "00");
  EXPECT_EQ(checked_line("99b"), "99");
  EXPECT_EQ(checked_line("99c"), std::nullopt);
  EXPECT_EQ(checked_parameter("DMAX:5600;_"), "DMAX:5600");
  EXPECT_EQ(checked_parameter("DMAX:5601;_"), std::nullopt);
}

// What a URG-04LX answers to PP, from its manual.
TEST(ScipParameters, AreThoseOfTheManual) {
  const auto p = parse_scip_parameters({"MODL:URG-04LX(Hokuyo Automatic Co.,Ltd.);N", "DMIN:20;4",
                                        "DMAX:5600;_", "ARES:1024;\\", "AMIN:44;7", "AMAX:725;o",
                                        "AFRT:384;6", "SCAN:600;e"});
  ASSERT_TRUE(p);
  EXPECT_EQ(p->model, "URG-04LX(Hokuyo Automatic Co.,Ltd.)");
  EXPECT_EQ(p->num_beams(), 682);
  EXPECT_EQ(p->range_min_mm, 20);
  EXPECT_EQ(p->range_max_mm, 5600);
  EXPECT_NEAR(p->bearing_min_rad(), (44 - 384) * 2 * kPi / 1024, 1e-12);
  EXPECT_NEAR(p->turn_us(), 100e3, 1e-6);            // 600 rpm
  EXPECT_NEAR(p->beam_period_us(), 97.65625, 1e-9);  // of a whole turn, not of the field of view
}

TEST(ScipParameters, AMissingOrBrokenNumberIsNoScanner) {
  EXPECT_FALSE(parse_scip_parameters(
      {"DMIN:20;4", "DMAX:5600;_", "ARES:1024;\\", "AMIN:44;7", "AMAX:725;o", "AFRT:384;6"}));
  EXPECT_FALSE(parse_scip_parameters({"DMIN:20;5", "DMAX:5600;_", "ARES:1024;\\", "AMIN:44;7",
                                      "AMAX:725;o", "AFRT:384;6", "SCAN:600;e"}));
}

TEST(ScipParameters, TheMotorsSpeedIsRead) {
  EXPECT_EQ(parse_scip_motor_rpm({"SCSP:Initial(540[rpm]);^"}), 540.0);
  EXPECT_EQ(parse_scip_motor_rpm({"SCSP:Initial(541[rpm]);^"}), std::nullopt);
}

/// Four beams, at 2 to 5 of 16 steps, 4 looking ahead; 10 turns a second.
constexpr const char* kSmallScanner =
    "PP\n00P\nDMIN:20;4\nDMAX:5600;_\nARES:16;<\nAMIN:2;A\nAMAX:5;F\nAFRT:4;K\nSCAN:600;e\n\n";

ScipParameters small_scanner() {
  return *parse_scip_parameters(
      {"DMIN:20;4", "DMAX:5600;_", "ARES:16;<", "AMIN:2;A", "AMAX:5;F", "AFRT:4;K", "SCAN:600;e"});
}

// 1234 mm, 5432 mm, error code 19, and 5601 mm: one more than it can measure.
TEST(ScipSweep, RangesAreReadAndCodesAreNoReturn) {
  const auto sweep =
      parse_scip_sweep({"m2@0?", "0CB1Dh00C1GQn"}, small_scanner(), ScipEncoding::kThree);
  ASSERT_TRUE(sweep);
  EXPECT_EQ(sweep->ticks, 16'000'000u);
  EXPECT_EQ(sweep->scan.ranges_m, (std::vector<float>{1.234f, 5.432f, 0.0f, 0.0f}));
  EXPECT_TRUE(sweep->scan.intensities.empty());
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(sweep->scan.bearing_rad(i), (2 + i - 4) * 2 * kPi / 16, 1e-9);
  }
}

TEST(ScipSweep, TwoCharactersAndIntensities) {
  const auto two = parse_scip_sweep({"m2@0?", "CBoo0CP0F"}, small_scanner(), ScipEncoding::kTwo);
  ASSERT_TRUE(two);  // 1234, 4095, 19, 2048 mm
  EXPECT_EQ(two->scan.ranges_m, (std::vector<float>{1.234f, 4.095f, 0.0f, 2.048f}));
  const auto both = parse_scip_sweep({"m2@0?", "0CB03h1Dh00200C0001GQ000k"}, small_scanner(),
                                     ScipEncoding::kThreeWithIntensity);
  ASSERT_TRUE(both);
  EXPECT_EQ(both->scan.ranges_m, (std::vector<float>{1.234f, 5.432f, 0.0f, 0.0f}));
  EXPECT_EQ(both->scan.intensities, (std::vector<float>{248.0f, 2.0f, 0.0f, 0.0f}));
}

TEST(ScipSweep, EverySingleChangedCharacterIsNoticed) {
  const std::vector<std::string> lines = {"m2@0?", "0CB1Dh00C1GQn"};
  for (std::size_t l = 0; l < lines.size(); ++l) {
    for (std::size_t i = 0; i < lines[l].size(); ++i) {
      for (int c = 0; c < 256; ++c) {
        std::vector<std::string> broken = lines;
        broken[l][i] = static_cast<char>(c);
        if (broken == lines) continue;
        EXPECT_FALSE(
            parse_scip_sweep({broken[0], broken[1]}, small_scanner(), ScipEncoding::kThree))
            << l << " " << i << " " << c;
      }
    }
  }
}

TEST(ScipSweep, TooFewAndTooManyBeamsAreRefused) {
  EXPECT_FALSE(parse_scip_sweep({"m2@0?", "0CB1Dh00Ch"}, small_scanner(), ScipEncoding::kThree));
  EXPECT_FALSE(
      parse_scip_sweep({"m2@0?", "0CB1Dh00C1GQn", "0CBE"}, small_scanner(), ScipEncoding::kThree));
  EXPECT_FALSE(parse_scip_sweep({"m2@0?"}, small_scanner(), ScipEncoding::kThree));
  EXPECT_FALSE(parse_scip_sweep({}, small_scanner(), ScipEncoding::kThree));
}

/// Leads a talk up to the stream; gives what the host sent last.
std::string lead_to_stream(ScipProtocol& scip) {
  scip.connected(0);
  EXPECT_EQ(scip.take_to_send(), "QT\n");
  scip.receive("99b\nm2@0?\n\nQT\n00P\n\n", 0);  // the rest of an earlier talk before it
  EXPECT_EQ(scip.take_to_send(), "PP\n");
  scip.receive(kSmallScanner, 0);
  EXPECT_EQ(scip.take_to_send(), "II\n");
  scip.receive("II\n0Ee\n\n", 0);
  EXPECT_EQ(scip.take_to_send(), "TM0\n");
  scip.receive("TM0\n0Ee\n\n", 0);
  EXPECT_EQ(scip.take_to_send(), "BM\n");
  scip.receive("BM\n00P\n\n", 0);
  EXPECT_EQ(scip.take_to_send(), "ME0002000500000\n");
  scip.receive("ME0002000500000\n0Ee\n\n", 0);
  return scip.take_to_send();
}

TEST(ScipProtocol, TheSimplestScannerIsAskedForRangesAlone) {
  ScipProtocol scip;
  EXPECT_EQ(lead_to_stream(scip), "MD0002000500000\n");
  scip.receive("MD0002000500000\n00P\n\n", 0);
  EXPECT_EQ(scip.condition(), "waits for the scanner's first scan");
  // In two pieces, as a serial line hands them over.
  const std::string sweep = "MD0002000500000\n99b\nm2@0?\n0CB1Dh00C1GQn\n\n";
  scip.receive(sweep.substr(0, 30), 1'000'000);
  EXPECT_TRUE(scip.take_measurements().empty());
  scip.receive(sweep.substr(30), 1'000'000);
  const auto measured = scip.take_measurements();
  ASSERT_EQ(measured.size(), 1u);
  // It arrives when the beam at step 5 has been measured; the first published one is step 2. The
  // stamp is a millisecond long, and its middle is taken.
  EXPECT_NEAR(static_cast<double>(std::get<laser::Scan>(measured[0]).utime),
              1e6 - 3 * 100e3 / 16 + 500, 1.0);
  EXPECT_EQ(scip.condition(), "");
  EXPECT_EQ(scip.counts().num_good, 1);
  EXPECT_EQ(scip.counts().num_bad, 0);
}

TEST(ScipProtocol, ABrokenSweepIsCountedAndTheNextOneRead) {
  ScipProtocol scip;
  lead_to_stream(scip);
  scip.receive(
      "MD0002000500000\n00P\n\nMD0002000500000\n99b\nm2@0?\n0CB1Dh00C1GQo\n\n"
      "MD0002000500000\n99b\nm2@0?\n0CB1Dh00C1GQn\n\n",
      0);
  EXPECT_EQ(scip.take_measurements().size(), 1u);
  EXPECT_EQ(scip.counts().num_bad, 1);
}

TEST(ScipProtocol, TwoSweepsOfOneTimeAreOne) {
  ScipProtocol scip;
  lead_to_stream(scip);
  for (int i = 0; i < 2; ++i) {
    scip.receive("MD0002000500000\n99b\nm2@0?\n0CB1Dh00C1GQn\n\n", i * 1000);
  }
  EXPECT_EQ(scip.take_measurements().size(), 1u);
  EXPECT_EQ(scip.counts().num_good, 1);
  EXPECT_EQ(scip.counts().num_bad, 1);
}

TEST(ScipProtocol, SilenceAsksAgainAndThenWantsANewConnection) {
  ScipProtocol scip;
  scip.connected(0);
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(scip.deadline());
    scip.expire(*scip.deadline());
    EXPECT_EQ(scip.failure(), "");
  }
  EXPECT_EQ(scip.take_to_send(), "QT\n\nSCIP2.0\nQT\n\nSCIP2.0\nQT\n");
  scip.expire(*scip.deadline());
  EXPECT_NE(scip.failure().find("no answer to QT"), std::string::npos);
  scip.connected(5'000'000);
  EXPECT_EQ(scip.failure(), "");
}

TEST(ScipProtocol, AScannerThatFallsSilentIsStartedAgain) {
  ScipProtocol scip;
  lead_to_stream(scip);
  scip.receive("MD0002000500000\n99b\nm2@0?\n0CB1Dh00C1GQn\n\n", 1'000'000);
  ASSERT_TRUE(scip.deadline());
  EXPECT_LE(*scip.deadline(), 2'000'000);
  scip.expire(*scip.deadline());
  EXPECT_EQ(scip.take_to_send(), "QT\n");
  EXPECT_EQ(scip.condition(), "the scanner sends no scans");
}

TEST(ScipProtocol, TroubleThatTheScannerReportsIsSaid) {
  ScipProtocol scip;
  lead_to_stream(scip);
  scip.receive("MD0002000500000\n50U\n\n", 0);
  EXPECT_EQ(scip.condition(), "the scanner reports status 50: hardware fault (laser, motor)");
}

TEST(ScipProtocol, RubbishWithoutEndIsNotKept) {
  ScipProtocol scip;
  lead_to_stream(scip);
  const std::string rubbish(70'000, 'x');
  for (int i = 0; i < 10; ++i) scip.receive(rubbish, 0);
  EXPECT_EQ(scip.counts().num_bad, 5);
}

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
