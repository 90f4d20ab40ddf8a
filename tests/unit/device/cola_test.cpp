// SPDX-License-Identifier: BSD-3-Clause
// CoLa-A and CoLa-B against telegrams written by hand from SICK's telegram listing (8014631).
#include <gtest/gtest.h>

#include "device/cola/cola_protocol.hpp"

namespace orchard::device {
namespace {

constexpr double kPi = 3.14159265358979323846;

TEST(ColaFields, NumbersOfEveryKind) {
  ColaFields fields(ColaDialect::kA, "1F4 FFF92230 +100 -15 3F800000 40000000 text");
  EXPECT_EQ(fields.number(4), 500u);
  EXPECT_EQ(fields.signed_number(), -450'000);
  EXPECT_EQ(fields.signed_number(), 100);
  EXPECT_EQ(fields.signed_number(), -15);
  EXPECT_EQ(fields.real(), 1.0f);
  EXPECT_EQ(fields.real(), 2.0f);
  EXPECT_EQ(fields.text(4), "text");
  EXPECT_TRUE(fields.ok());
  fields.word();
  EXPECT_FALSE(fields.ok());
}

TEST(ColaFields, WhatIsNoNumberEndsIt) {
  for (const char* text : {"", " 1", "1G", "123456789", "-1", "0x1", "1  2"}) {
    ColaFields fields(ColaDialect::kA, text);
    fields.number(4);
    fields.number(4);
    EXPECT_FALSE(fields.ok()) << text;
  }
}

TEST(ColaFields, AfterOneThatIsNoneEveryKindReadsNothing) {
  ColaFields fields(ColaDialect::kA, "x +100");
  fields.number(4);
  EXPECT_EQ(fields.signed_number(), 0);
  EXPECT_EQ(fields.real(), 0.0f);
  EXPECT_EQ(fields.text(1), "");
  EXPECT_FALSE(fields.ok());
}

/// Five beams from -45 degrees in steps of a third: 500, 0, 1000, 3, 65535 mm; 15 turns a second;
/// begun at 1,000,000 us and sent at 1,050,000 us of the device's clock.
const std::string kHead = "1 1 89A27F 0 0 1A 1B F4240 100590 0 0 3F 0 0 5DC 21C 0";
const std::string kDistances = "DIST1 3F800000 00000000 FFF92230 D05 5 1F4 0 3E8 3 FFFF";
const std::string kTail = " 0 0 0 0 0";

/// The scan in the fields of a CoLa-A telegram.
std::optional<ColaScan> read_scan(std::string_view fields, const ColaModel& model,
                                  const std::optional<ColaRange>& range) {
  return parse_cola_scan({ColaDialect::kA, fields}, model, range);
}

TEST(ColaScan, AnglesRangesAndTimesAreThoseOfTheTelegram) {
  const auto sweep =
      read_scan(kHead + " 1 " + kDistances + " 0" + kTail, cola_model("TiM561-2050101"), {});
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
  const auto range = parse_cola_range({ColaDialect::kA, "1 D05 FFF92230 FFF95645"});
  ASSERT_TRUE(range);
  EXPECT_EQ(range->stop, -436'667);
  const auto sweep = read_scan(kHead + " 1 " + kDistances + " 0" + kTail, {}, range);
  ASSERT_TRUE(sweep);
  EXPECT_NEAR(sweep->scan.bearing_step_rad, 1.33330 / 4 * kPi / 180.0, 1e-9);
  EXPECT_NEAR(sweep->scan.bearing_rad(4), (-43.6667 - 90.0) * kPi / 180.0, 1e-9);
  // Ends that do not fit are not believed.
  const auto other =
      read_scan(kHead + " 1 " + kDistances + " 0" + kTail, {}, ColaRange{-450'000, 2'250'000});
  EXPECT_NEAR(other->scan.bearing_step_rad, 0.3333 * kPi / 180.0, 1e-12);
}

// An LMS111 says -44.9997 to 224.9997 degrees in LMPoutputRange, and -45 in its sweeps of half
// degrees.
TEST(ColaScan, TheEndsMayDifferFromTheSweepsByTheDevicesOwnRounding) {
  const auto range = parse_cola_range({ColaDialect::kA, "1 1388 FFF92233 22550D"});
  ASSERT_TRUE(range);
  EXPECT_EQ(range->start, -449'997);
  std::string sweep = kHead + " 1 DIST1 3F800000 0 FFF92230 1387 21D";
  for (int i = 0; i < 541; ++i) sweep += " 1F4";
  const auto scan = read_scan(sweep + " 0", {}, range);
  ASSERT_TRUE(scan);
  EXPECT_NEAR(scan->scan.bearing_min_rad, -135.0 * kPi / 180.0, 1e-9);
  EXPECT_NEAR(scan->scan.bearing_step_rad, 269.9994 / 540 * kPi / 180.0, 1e-9);
  // From another beam on it is another range.
  const auto other = read_scan(sweep + " 0", {}, ColaRange{-447'497, 2'252'497});
  EXPECT_NEAR(other->scan.bearing_step_rad, 0.4999 * kPi / 180.0, 1e-9);
}

TEST(ColaScan, AnOutputThatBeginsLaterHasItsFirstBeamLater) {
  // From 0 degrees (to the right): an eighth of a turn after the first shot.
  const std::string later = "DIST1 3F800000 00000000 0 D05 2 1F4 1F4";
  const auto sweep = read_scan(kHead + " 1 " + later + " 0" + kTail, {}, {});
  ASSERT_TRUE(sweep);
  EXPECT_NEAR(sweep->to_first_beam_us, 1e6 / 15.0 / 8.0, 1e-6);
}

TEST(ColaScan, TheScaleIsAFactor) {
  const std::string doubled = "DIST1 40000000 00000000 FFF92230 1388 2 1F4 2710";
  const auto sweep = read_scan(kHead + " 1 " + doubled + " 0" + kTail, {}, {});
  ASSERT_TRUE(sweep);
  EXPECT_EQ(sweep->scan.ranges_m, (std::vector<float>{1.0f, 20.0f}));
}

TEST(ColaScan, IntensitiesComeIn16AndIn8Bits) {
  const std::string rssi = "RSSI1 3F800000 00000000 FFF92230 D05 5 1 2 3 4 ";
  const auto wide = read_scan(kHead + " 2 " + kDistances + " " + rssi + "FFFF 0" + kTail, {}, {});
  ASSERT_TRUE(wide);
  EXPECT_EQ(wide->scan.intensities, (std::vector<float>{1, 2, 3, 4, 65535}));
  const auto narrow = read_scan(kHead + " 1 " + kDistances + " 1 " + rssi + "FF" + kTail, {}, {});
  ASSERT_TRUE(narrow);
  EXPECT_EQ(narrow->scan.intensities, (std::vector<float>{1, 2, 3, 4, 255}));
}

TEST(ColaScan, WhatIsCutOffAnywhereInTheDataIsRefused) {
  const std::string whole = kHead + " 1 " + kDistances + " 0";
  ASSERT_TRUE(read_scan(whole, {}, {}));
  for (std::size_t size = 0; size + 1 < whole.size(); ++size) {
    EXPECT_FALSE(read_scan(whole.substr(0, size), {}, {})) << whole.substr(0, size);
  }
}

TEST(ColaScan, HostileCountsAndAnglesAreRefused) {
  for (const char* channels :
       {"FFFFFFFF", "10", "1 DIST1 3F800000 00000000 0 D05 FFFFFFFF 1",
        "1 DIST1 7FC00000 0 0 D05 2 1 1", "1 DIST1 3F800000 0 0 0 2 1 1",
        "1 DIST1 3F800000 0 7FFFFFFF D05 2 1 1", "1 DIST1 3F800000 0 80000000 D05 2 1 1",
        "1 DIST1 3F800000 0 0 D05 1 1", "1 DIST1 3F800000 0 0 D05 2 1 10000",
        "1 RSSI1 3F800000 0 0 D05 2 1 1"}) {
    EXPECT_FALSE(read_scan(kHead + " " + channels + " 0" + kTail, {}, {})) << channels;
  }
}

std::string telegram(const std::string& text) { return "\x02" + text + "\x03"; }

std::string sweep_telegram(const std::string& channels = " 1 " + kDistances + " 0") {
  return telegram("sSN LMDscandata " + kHead + channels + kTail);
}

std::string sent(ColaProtocol& cola) {
  std::string text = cola.take_to_send();
  if (text.size() < 2) return text;
  return text.substr(1, text.size() - 2);
}

TEST(ColaProtocol, AsksForIntensitiesWhereItMayLogIn) {
  ColaProtocol cola;
  cola.connected(0);
  EXPECT_EQ(sent(cola), "sEN LMDscandata 0");
  cola.receive(sweep_telegram(), 0);  // of an earlier talk
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
  EXPECT_EQ(cola.condition().text, "waits for the scanner's first scan");
  // Sent 50 ms after it began, and read 100 us after it was sent: nothing is known to be quicker.
  cola.receive(sweep_telegram(), 2'000'000);
  const auto measured = cola.take_measurements();
  ASSERT_EQ(measured.size(), 1u);
  EXPECT_NEAR(static_cast<double>(std::get<laser::Scan>(measured[0]).utime), 1'950'000.0, 2.0);
  EXPECT_EQ(std::get<laser::Scan>(measured[0]).range_max_m, 10.0);
  EXPECT_EQ(cola.condition().severity, Severity::kNone);
  EXPECT_EQ(cola.condition().text, "CoLa-A; stamped by its start of the sweep");
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
  EXPECT_EQ(cola.condition().text, "waits for the scanner's answer to sEN LMDscandata");
  cola.receive(sweep_telegram(), 1'000'000);
  EXPECT_EQ(cola.take_measurements().size(), 1u);
  EXPECT_EQ(cola.condition().severity, Severity::kNone);
}

TEST(ColaProtocol, ADeviceInTroubleSaysSo) {
  ColaProtocol cola;
  cola.connected(0);
  for (const char* answer : {"sEA LMDscandata 0", "sFA 3", "sFA 3", "sFA 3", "sEA LMDscandata 1"}) {
    cola.receive(telegram(answer), 0);
  }
  std::string dirty = sweep_telegram();
  dirty.replace(dirty.find(" 0 0 1A"), 7, " 0 2 1A");
  cola.receive(dirty, 0);
  EXPECT_EQ(cola.take_measurements().size(), 1u);
  EXPECT_EQ(cola.condition().severity, Severity::kWarning);
  EXPECT_EQ(cola.condition().text, "the scanner reports a dirty front screen; clean it");
  dirty.replace(dirty.find(" 0 2 1A"), 7, " 0 1 1A");
  cola.receive(dirty, 0);
  EXPECT_TRUE(cola.take_measurements().empty());
  EXPECT_EQ(cola.counts().num_bad, 1);
  EXPECT_EQ(cola.condition().severity, Severity::kError);
}

TEST(ColaProtocol, HalfATelegramIsForgottenAtTheNextStart) {
  ColaProtocol cola;
  cola.connected(0);
  cola.take_to_send();
  cola.receive("\x02sEA LMD\x02sEA LMDscandata 0\x03", 0);
  EXPECT_EQ(sent(cola), "sRN DeviceIdent");
}

// The listing's own example: sEN LMDscandata 1 (4.3.4).
TEST(ColaFrame, IsThatOfTheListing) {
  const std::string content("sEN LMDscandata \x01", 17);
  const std::string binary("\x02\x02\x02\x02\x00\x00\x00\x11sEN LMDscandata \x01\x33", 26);
  EXPECT_EQ(framed(ColaDialect::kB, content), binary);
  EXPECT_EQ(framed(ColaDialect::kA, "sEN LMDscandata 1"), "\x02sEN LMDscandata 1\x03");
  const ColaPiece piece = first_piece(ColaDialect::kB, binary, 1000);
  EXPECT_EQ(piece.kind, ColaPiece::Kind::kTelegram);
  EXPECT_EQ(piece.num_bytes, binary.size());
  EXPECT_EQ(piece.telegram, content);
}

TEST(ColaFrame, EveryCutAndEveryChangedByteIsNoticed) {
  const std::string whole = framed(ColaDialect::kB, std::string("sEA LMDscandata \x01", 17));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_EQ(first_piece(ColaDialect::kB, whole.substr(0, size), 1000).kind,
              ColaPiece::Kind::kIncomplete);
  }
  for (std::size_t i = 0; i < whole.size(); ++i) {
    for (int c = 0; c < 256; ++c) {
      std::string broken = whole;
      broken[i] = static_cast<char>(c);
      if (broken == whole) continue;
      EXPECT_NE(first_piece(ColaDialect::kB, broken, 1000).kind, ColaPiece::Kind::kTelegram);
    }
  }
}

// Whatever is wrong with the first, the second is found, and as soon as it is whole.
TEST(ColaFrame, AfterABrokenTelegramTheNextIsFound) {
  for (const ColaDialect dialect : {ColaDialect::kA, ColaDialect::kB}) {
    const std::string first = framed(dialect, "sEA first"), second = framed(dialect, "sEA second");
    for (std::size_t i = 0; i < first.size(); ++i) {
      for (const bool is_cut : {true, false}) {
        std::string bytes = first;
        is_cut ? bytes.erase(i, 1) : bytes.replace(i, 1, 1, static_cast<char>(bytes[i] ^ 0x41));
        bytes += second;
        std::string found;
        for (ColaPiece piece; (piece = first_piece(dialect, bytes, 1000)).num_bytes > 0;) {
          found = std::string(piece.telegram);
          bytes.erase(0, piece.num_bytes);
        }
        EXPECT_EQ(found, "sEA second") << name_of(dialect) << " " << i << is_cut;
        EXPECT_EQ(bytes, "");
      }
    }
  }
}

/// The small sweep in binary fields, by the sizes of the listing (4.3.5).
std::string binary_sweep(std::uint16_t number = 26, std::uint32_t start_us = 1'000'000,
                         std::uint32_t sent_us = 1'050'000) {
  std::string bytes = "sSN LMDscandata ";
  const auto add = [&bytes](std::uint32_t value, int num_bytes) {
    for (int i = num_bytes - 1; i >= 0; --i) bytes += static_cast<char>(value >> (8 * i) & 0xff);
  };
  add(1, 2), add(1, 2), add(0x89a27f, 4), add(0, 1), add(0, 1), add(number, 2), add(27, 2);
  add(start_us, 4), add(sent_us, 4), add(0, 2), add(0x3f00, 2), add(0, 2);
  add(1500, 4), add(0x21c, 4), add(0, 2), add(1, 2);
  bytes += "DIST1";
  add(0x3f800000, 4), add(0, 4), add(0xfff92230, 4), add(3333, 2), add(5, 2);
  for (const std::uint32_t value : {500u, 0u, 1000u, 3u, 65535u}) add(value, 2);
  for (int i = 0; i < 6; ++i) add(0, 2);
  return bytes;
}

TEST(ColaScan, BinaryFieldsHoldTheSame) {
  const std::string bytes = binary_sweep();
  ColaFields fields(ColaDialect::kB, bytes);
  EXPECT_EQ(fields.word(), "sSN");
  EXPECT_EQ(fields.word(), "LMDscandata");
  const auto binary = parse_cola_scan(fields, {}, {});
  const auto text = read_scan(kHead + " 1 " + kDistances + " 0" + kTail, {}, {});
  ASSERT_TRUE(binary && text);
  EXPECT_EQ(binary->num_sent, text->num_sent);
  EXPECT_EQ(binary->start_ticks, text->start_ticks);
  EXPECT_EQ(binary->sent_ticks, text->sent_ticks);
  EXPECT_EQ(binary->scan.ranges_m, text->scan.ranges_m);
  EXPECT_EQ(binary->scan.bearing_min_rad, text->scan.bearing_min_rad);
  EXPECT_EQ(binary->scan.beam_period_us, text->scan.beam_period_us);
  for (std::size_t size = 16; size + 12 < bytes.size(); ++size) {
    EXPECT_FALSE(parse_cola_scan({ColaDialect::kB, bytes.substr(16, size - 16)}, {}, {})) << size;
  }
}

/// Leads a talk in CoLa-B up to the stream.
void lead_to_binary_stream(ColaProtocol& cola) {
  cola.connected(0);
  EXPECT_EQ(sent(cola), "sEN LMDscandata 0");
  cola.expire(*cola.deadline());  // no answer to CoLa-A
  const auto binary = [](std::string_view content) { return framed(ColaDialect::kB, content); };
  using std::string_view_literals::operator""sv;
  EXPECT_EQ(cola.take_to_send(), binary("sEN LMDscandata \0"sv));
  cola.receive(binary("sEA LMDscandata \0"sv), 0);
  EXPECT_EQ(cola.take_to_send(), binary("sRN DeviceIdent"));
  cola.receive(binary("sRA DeviceIdent \0\x0eTiM561-2050101\0\6V2.5.0"sv), 0);
  EXPECT_EQ(cola.take_to_send(), binary("sRN LMPoutputRange"));
  cola.receive(binary("sRA LMPoutputRange \0\1\0\0\r\x05\xff\xf9\x22\x30\0\x22\x55\x10"sv), 0);
  EXPECT_EQ(cola.take_to_send(), binary("sMN SetAccessMode \3\xf4\x72\x47\x44"sv));
  cola.receive(binary("sAN SetAccessMode \1"sv), 0);
  EXPECT_EQ(cola.take_to_send(), binary("sWN LMDscandatacfg \1\0\1\1\0\0\0\0\0\0\0\0\1"sv));
  cola.receive(binary("sWA LMDscandatacfg "), 0);
  EXPECT_EQ(cola.take_to_send(), binary("sMN Run"));
  cola.receive(binary("sAN Run \1"sv), 0);
  EXPECT_EQ(cola.take_to_send(), binary("sEN LMDscandata \1"sv));
  cola.receive(binary("sEA LMDscandata \1"sv), 0);
}

TEST(ColaProtocol, ADeviceThatAnswersNothingToCoLaAIsAskedInCoLaB) {
  ColaProtocol cola;
  lead_to_binary_stream(cola);
  cola.receive(framed(ColaDialect::kB, binary_sweep()), 2'000'000);
  const auto measured = cola.take_measurements();
  ASSERT_EQ(measured.size(), 1u);
  EXPECT_NEAR(static_cast<double>(std::get<laser::Scan>(measured[0]).utime), 1'950'000.0, 2.0);
  EXPECT_EQ(std::get<laser::Scan>(measured[0]).range_max_m, 10.0);
  EXPECT_EQ(cola.condition().text, "CoLa-B; stamped by its start of the sweep");
  cola.connected(10'000'000);  // what it speaks is known
  EXPECT_EQ(cola.take_to_send().substr(0, 4), "\x02\x02\x02\x02");
}

TEST(ColaProtocol, WithoutAnswerBothDialectsAreAskedThreeTimes) {
  ColaProtocol cola;
  cola.connected(0);
  int num_text = 0, num_binary = 0;
  while (cola.failure().empty()) {
    const std::string asked = cola.take_to_send();
    (asked.substr(0, 2) == "\x02\x02" ? num_binary : num_text) += 1;
    cola.expire(*cola.deadline());
  }
  EXPECT_EQ(num_text, 3);
  EXPECT_EQ(num_binary, 3);
  EXPECT_EQ(cola.condition().severity, Severity::kError);
  EXPECT_NE(cola.failure().find("in CoLa-A and CoLa-B"), std::string::npos);
}

TEST(ColaProtocol, ASweepThatIsSentAgainIsNoOther) {
  ColaProtocol cola;
  lead_to_binary_stream(cola);
  for (int i = 0; i < 2; ++i) {
    cola.receive(framed(ColaDialect::kB, binary_sweep()), 2'000'000 + 3000 * i);
  }
  EXPECT_EQ(cola.take_measurements().size(), 1u);
  EXPECT_EQ(cola.counts().num_bad, 0);
}

// Four beams of a third of a degree last 0.25 ms at 15 Hz; sent 0.2 ms after the stamp, that cannot
// be the first beam's.
TEST(ColaProtocol, AStampTooLateForTheFirstBeamIsNotTakenForIt) {
  ColaProtocol cola;
  lead_to_binary_stream(cola);
  const double sweep_us = 4 * 0.3333 / 360.0 / 15.0 * 1e6;
  ASSERT_GT(sweep_us, 200.0);
  cola.receive(framed(ColaDialect::kB, binary_sweep(26, 1'000'000, 1'000'200)), 2'000'000);
  const auto measured = cola.take_measurements();
  ASSERT_EQ(measured.size(), 1u);
  EXPECT_NEAR(static_cast<double>(std::get<laser::Scan>(measured[0]).utime), 2e6 - sweep_us, 2.0);
  EXPECT_EQ(cola.condition().text, "CoLa-B; stamped by its transmission minus the sweep");
}

TEST(ColaProtocol, ManyRefusedSweepsAreAWarningWithTheirReason) {
  ColaProtocol cola;
  lead_to_binary_stream(cola);
  for (unsigned i = 0; i < 100; ++i) {
    const std::uint32_t time_us = 1'000'000 + 66'667 * i;
    std::string telegram = framed(
        ColaDialect::kB, binary_sweep(static_cast<std::uint16_t>(i), time_us, time_us + 50'000));
    if (i % 10 < 7) telegram[40] ^= 1;
    cola.receive(telegram, 2'000'000 + 66'667 * i);
    EXPECT_EQ(cola.condition().severity, i == 0 ? Severity::kWaiting : Severity::kWarning);
  }
  EXPECT_EQ(cola.take_measurements().size(), 30u);
  EXPECT_EQ(cola.counts().num_bad, 70);
  EXPECT_EQ(cola.condition().text,
            "70 of 100 sweeps refused in 10 s: a telegram that is cut off or has a wrong checksum");
}

}  // namespace
}  // namespace orchard::device
