// SPDX-License-Identifier: BSD-3-Clause
// SCIP 2.0 against frames encoded by hand from its specification, C-42-03320B.
#include <gtest/gtest.h>

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

/// Leads a talk up to the stream, to which the scanner answers; gives what the host sent last.
std::string lead_to_stream(ScipProtocol& scip,
                           const std::string& answer = "ME0002000500000\n0Ee\n\n") {
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
  scip.receive(answer, 0);
  return scip.take_to_send();
}

TEST(ScipProtocol, TheSimplestScannerIsAskedForRangesAlone) {
  ScipProtocol scip;
  EXPECT_EQ(lead_to_stream(scip), "MD0002000500000\n");
  scip.receive("MD0002000500000\n00P\n\n", 0);
  EXPECT_EQ(scip.condition().text, "waits for the scanner's first scan");
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
  EXPECT_EQ(scip.condition().text, "");
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

TEST(ScipProtocol, OfHalfASweepOnlyThatOneIsLost) {
  const std::string sweep = "MD0002000500000\n99b\nm2@0?\n0CB1Dh00C1GQn\n\n";
  for (std::size_t size = 16; size < sweep.size(); ++size) {
    ScipProtocol scip;
    lead_to_stream(scip);
    scip.receive("MD0002000500000\n00P\n\n" + sweep.substr(0, size) + sweep, 0);
    EXPECT_EQ(scip.take_measurements().size(), 1u) << size;
    EXPECT_EQ(scip.counts().num_good, 1) << size;
    EXPECT_EQ(scip.counts().num_bad, 1) << size;
  }
}

// What it refuses while it gets ready it grants later, with its intensities.
TEST(ScipProtocol, AScannerThatIsGettingReadyIsAskedAgain) {
  ScipProtocol scip;
  EXPECT_EQ(lead_to_stream(scip, "ME0002000500000\n10Q\n\n"), "");
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(scip.failure(), "");
    EXPECT_EQ(scip.condition().severity, Severity::kWaiting);
    EXPECT_EQ(scip.condition().text, "the scanner is not ready for ME0002000500000: status 10");
    scip.expire(*scip.deadline());
    EXPECT_EQ(scip.take_to_send(), "ME0002000500000\n");
    scip.receive("ME0002000500000\n10Q\n\n", 500'000 * (i + 1));
  }
  scip.expire(*scip.deadline());
  scip.receive(
      "ME0002000500000\n00P\n\n"
      "ME0002000500000\n99b\nm2@0?\n0CB03h1Dh00200C0001GQ000k\n\n",
      3'200'000);
  const auto measured = scip.take_measurements();
  ASSERT_EQ(measured.size(), 1u);
  EXPECT_EQ(std::get<laser::Scan>(measured[0]).intensities.size(), 4u);
  EXPECT_EQ(scip.condition().severity, Severity::kNone);
}

TEST(ScipProtocol, OneThatNeverGetsReadySaysWhy) {
  ScipProtocol scip;
  lead_to_stream(scip, "ME0002000500000\n10Q\n\n");
  while (scip.failure().empty()) {
    const std::int64_t now = *scip.deadline();
    ASSERT_LT(now, 20'000'000);
    scip.expire(now);
    const std::string asked = scip.take_to_send();
    if (!asked.empty()) scip.receive(asked + "10Q\n\n", now);
  }
  EXPECT_EQ(scip.failure(), "the scanner is not ready for MD0002000500000: status 10");
  EXPECT_EQ(scip.condition().severity, Severity::kError);
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
  EXPECT_EQ(scip.condition().text, "the scanner sends no scans");
}

TEST(ScipProtocol, TroubleThatTheScannerReportsIsSaid) {
  ScipProtocol scip;
  lead_to_stream(scip);
  scip.receive("MD0002000500000\n50U\n\n", 0);
  EXPECT_EQ(scip.condition().text, "the scanner reports status 50: hardware fault (laser, motor)");
  EXPECT_EQ(scip.condition().severity, Severity::kError);
}

TEST(ScipProtocol, RubbishWithoutEndIsNotKept) {
  ScipProtocol scip;
  lead_to_stream(scip);
  const std::string rubbish(70'000, 'x');
  for (int i = 0; i < 10; ++i) scip.receive(rubbish, 0);
  EXPECT_EQ(scip.counts().num_bad, 5);
}

}  // namespace
}  // namespace orchard::device
