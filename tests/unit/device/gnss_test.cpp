// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "device/gnss/gpsd_protocol.hpp"

namespace orchard::device {
namespace {

constexpr std::int64_t kFixTime_us = 1777889472000000;    // 2026-05-04T10:11:12Z
constexpr std::int64_t kHost_us = 1'700'000'000'000'000;  // a host that has its own idea of time

/// A fix `i` fifths of a second after 10:11:12.
std::string tpv(int i, const std::string& more = "") {
  char text[300];
  std::snprintf(text, sizeof text,
                "{\"class\":\"TPV\",\"device\":\"/dev/ttyACM0\",\"mode\":3,"
                "\"time\":\"2026-05-04T10:%02d:%02d.%d00Z\",\"lat\":-32.4,\"lon\":-71.3,"
                "\"altHAE\":51.5%s}\r\n",
                11 + (12 + i / 5) / 60, (12 + i / 5) % 60, i % 5 * 2, more.c_str());
  return text;
}

std::vector<pose::Gnss> taken(Protocol& protocol) {
  std::vector<pose::Gnss> fixes;
  for (const Measurement& measurement : protocol.take_measurements()) {
    fixes.push_back(std::get<pose::Gnss>(measurement));
  }
  return fixes;
}

GpsdProtocol connected(const GnssDriverConfig& config = {}) {
  GpsdProtocol protocol(config);
  protocol.connected(kHost_us);
  return protocol;
}

TEST(GpsdProtocol, AsksForReportsOfTheReceiverThatWasChosen) {
  EXPECT_EQ(connected().take_to_send(), "?WATCH={\"enable\":true,\"json\":true};\n");
  GnssDriverConfig config;
  config.receiver = "/dev/tty\"ACM0";
  EXPECT_EQ(connected(config).take_to_send(),
            "?WATCH={\"enable\":true,\"json\":true,\"device\":\"/dev/tty\\\"ACM0\"};\n");
}

TEST(GpsdProtocol, NamesTheQualityByGga) {
  // gpsd_json(5): status 1 normal, 2 DGPS, 3 RTK fixed, 4 RTK floating, 5 DR, 6 GNSSDR, 7 time,
  // 8 simulated, 9 P(Y). NMEA 0183 GGA: 1 single, 2 differential, 3 PPS, 4 RTK, 5 float, 6
  // estimated, 7 manual, 8 simulator.
  const int expected[] = {1, 1, 2, 4, 5, 6, 6, 7, 8, 3};
  for (int status = 0; status < 10; ++status) {
    GpsdFix fix;
    fix.mode = 3;
    fix.status = status;
    EXPECT_EQ(gga_quality(fix), expected[status]);
    fix.mode = 1;
    EXPECT_EQ(gga_quality(fix), 0);
  }
}

TEST(GpsdProtocol, TheCovarianceIsThatOfTheEllipse) {
  GpsdFix fix;
  fix.mode = 3;
  GpsdNoise noise;
  noise.major_sd_m = 0.03;
  noise.minor_sd_m = 0.01;
  noise.orientation_deg = 30.0;
  noise.up_sd_m = 0.05;
  noise.north_sd_m = noise.east_sd_m = 9.0;
  const auto covariance = enu_covariance(fix, &noise);
  // Along the axis 30 degrees from north to east the variance is the major one, across the minor.
  const double e = std::sin(M_PI / 6), n = std::cos(M_PI / 6);
  const auto along = [&](double east, double north) {
    return covariance[0] * east * east + 2 * covariance[1] * east * north +
           covariance[3] * north * north;
  };
  EXPECT_NEAR(along(e, n), 9e-4, 1e-12);
  EXPECT_NEAR(along(n, -e), 1e-4, 1e-12);
  EXPECT_NEAR(covariance[5], 25e-4, 1e-12);
  noise.major_sd_m.reset();
  EXPECT_DOUBLE_EQ(enu_covariance(fix, &noise)[0], 81.0);
}

TEST(GpsdProtocol, WithoutDeviationsTheErrorsCountUnlessTheyCannotBeOfRtk) {
  GpsdFix fix;
  fix.mode = 3;
  fix.status = 3;
  fix.eph_m = 0.02;
  fix.epv_m = 0.03;
  fix.epx_m = fix.epy_m = 2.0;
  EXPECT_NEAR(enu_covariance(fix, nullptr)[0], 4e-4, 1e-12);
  EXPECT_NEAR(enu_covariance(fix, nullptr)[5], 9e-4, 1e-12);
  fix.eph_m = 3.75;  // 3.75 m times a dilution of 1: gpsd's model, not the receiver's
  EXPECT_EQ(enu_covariance(fix, nullptr), (std::array<double, 6>{}));
  fix.status = 1;
  EXPECT_NEAR(enu_covariance(fix, nullptr)[3], 3.75 * 3.75, 1e-9);
  fix.eph_m.reset();
  EXPECT_NEAR(enu_covariance(fix, nullptr)[3], 4.0, 1e-9);
}

TEST(GpsdProtocol, StampsByArrivalWithoutItsJitter) {
  GnssDriverConfig config;
  config.latency_s = 0.15;
  GpsdProtocol protocol = connected(config);
  std::mt19937 random(5);
  std::vector<pose::Gnss> fixes;
  for (int i = 0; i < 1500; ++i) {
    // True: 150 ms at least, up to 80 ms more.
    const auto late_us = static_cast<std::int64_t>(150'000 + random() % 80'000);
    protocol.receive(tpv(i), kHost_us + 200'000 * i + late_us);
    for (const pose::Gnss& fix : taken(protocol)) fixes.push_back(fix);
  }
  ASSERT_EQ(fixes.size(), 1500u);
  for (std::size_t i = 100; i < fixes.size(); ++i) {
    // A part of the 80 ms: five fixes a second do not hold many quick ones.
    const double expected_us = 2e5 * static_cast<double>(i);
    EXPECT_NEAR(static_cast<double>(fixes[i].utime - kHost_us), expected_us, 30e3) << i;
  }
  EXPECT_EQ(protocol.counts().num_bad, 0);
}

TEST(GpsdProtocol, StampsByTheFixItselfWhereTheHostKeepsItsTime) {
  GnssDriverConfig config;
  config.stamp = GnssStamp::kFixTime;
  GpsdProtocol protocol = connected(config);
  protocol.receive(tpv(0), kFixTime_us + 120'000);
  ASSERT_EQ(taken(protocol).at(0).utime, kFixTime_us);
  EXPECT_EQ(protocol.condition().text, "");
  protocol.receive(tpv(1), kFixTime_us + 3'700'000);
  EXPECT_NE(protocol.condition().text.find("3.5 s after their own time"), std::string::npos);
}

TEST(GpsdProtocol, ARepeatedFixIsOneMeasurement) {
  GpsdProtocol protocol = connected();
  protocol.receive(tpv(0) + tpv(0) + tpv(1), kHost_us + 5);
  EXPECT_EQ(taken(protocol).size(), 2u);
}

/// A fix of mode 3 without its height.
std::string flat_tpv(int i) {
  std::string text = tpv(i);
  return text.replace(text.find(",\"altHAE\":51.5"), 14, "");
}

// gpsd 3.22 reports a fix first by RMC, without height, and again by GGA.
TEST(GpsdProtocol, AFixWaitsForItsHeight) {
  GpsdProtocol protocol = connected();
  protocol.receive(flat_tpv(0), kHost_us + 100'000);
  EXPECT_TRUE(taken(protocol).empty());
  protocol.receive(tpv(0), kHost_us + 150'000);
  const auto fixes = taken(protocol);
  ASSERT_EQ(fixes.size(), 1u);
  EXPECT_EQ(fixes[0].altitude_m, 51.5);
  EXPECT_NEAR(static_cast<double>(fixes[0].utime - kHost_us), 0.0, 1.0) << "it came with the first";
  // A receiver that sends no height has fixes, too.
  for (int i = 1; i < 6; ++i) protocol.receive(flat_tpv(i), kHost_us + 200'000 * i + 100'000);
  const auto flat = taken(protocol);
  ASSERT_EQ(flat.size(), 4u);
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(static_cast<double>(flat[static_cast<std::size_t>(i)].utime - kHost_us),
                2e5 * (i + 1), 1.0);
  }
}

// As of a Trimble RES720: the second report of a fix says that it is by dead reckoning.
TEST(GpsdProtocol, AFixWaitsForItsStatusWhereOneComes) {
  GpsdProtocol protocol = connected();
  std::string reports = tpv(0);  // not known yet
  for (int i = 0; i < 4; ++i) reports += (i > 0 ? tpv(i) : "") + tpv(i, ",\"status\":5");
  reports += tpv(4) + tpv(5) + tpv(6);  // and none any more
  protocol.receive(reports, kHost_us + 5);
  std::vector<int> qualities;
  for (const pose::Gnss& fix : taken(protocol)) qualities.push_back(fix.fix_quality);
  EXPECT_EQ(qualities, (std::vector<int>{1, 6, 6, 6, 1, 1, 1}));
}

TEST(GpsdProtocol, DeviationsOfAFloatSolutionAreNotThoseOfAFixedOne) {
  GpsdProtocol protocol = connected();
  const std::string gst =
      "{\"class\":\"GST\",\"device\":\"/dev/ttyACM0\",\"time\":\"2026-05-04T10:11:12.000Z\","
      "\"lat\":0.3,\"lon\":0.4,\"alt\":0.5}\r\n";
  protocol.receive(tpv(0, ",\"status\":4") + gst + tpv(1, ",\"status\":4") +
                       tpv(2, ",\"status\":3") + tpv(10, ",\"status\":4"),
                   kHost_us + 5);
  const auto fixes = taken(protocol);
  ASSERT_EQ(fixes.size(), 4u);
  EXPECT_EQ(fixes[0].covariance[0], 0.0);
  EXPECT_NEAR(fixes[1].covariance[0], 0.16, 1e-12);
  EXPECT_NEAR(fixes[1].covariance[3], 0.09, 1e-12);
  EXPECT_EQ(fixes[1].fix_quality, 5);
  EXPECT_EQ(fixes[2].covariance[0], 0.0);
  EXPECT_EQ(fixes[2].fix_quality, 4);
  EXPECT_EQ(fixes[3].covariance[0], 0.0);  // two seconds later
}

TEST(GpsdProtocol, SaysWhatIsMissingAndRecovers) {
  GpsdProtocol protocol = connected();
  EXPECT_EQ(protocol.condition().text, "waits for the first report");
  protocol.receive("{\"class\":\"DEVICES\",\"devices\":[]}\r\n", kHost_us + 5);
  EXPECT_NE(protocol.condition().text.find("no receiver"), std::string::npos);
  protocol.receive("{\"class\":\"TPV\",\"device\":\"/dev/ttyACM0\",\"mode\":1}\r\n", kHost_us + 9);
  EXPECT_EQ(protocol.condition().text, "the receiver has no fix yet");
  EXPECT_TRUE(taken(protocol).empty());
  protocol.receive(tpv(0), kHost_us + 20);
  EXPECT_EQ(protocol.condition().text, "");
  EXPECT_EQ(taken(protocol).size(), 1u);
  protocol.take_to_send();
  // Unplugged: gpsd is silent, and is asked whether it is there.
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(protocol.failure(), "");
    protocol.expire(*protocol.deadline());
    EXPECT_EQ(protocol.take_to_send(), "?DEVICES;\n");
  }
  EXPECT_NE(protocol.condition().text.find("still plugged in"), std::string::npos);
  EXPECT_EQ(protocol.failure(), "gpsd does not answer any more");
  protocol.connected(kHost_us + 20'000'000);
  EXPECT_EQ(protocol.failure(), "");
  protocol.receive(tpv(100), kHost_us + 20'000'100);
  EXPECT_EQ(taken(protocol).size(), 1u);
}

TEST(GpsdProtocol, ReadsOneOfTwoReceiversAndSaysSo) {
  GpsdProtocol protocol = connected();
  std::string other = tpv(1);
  other.replace(other.find("ACM0"), 4, "USB7");
  protocol.receive(tpv(0) + other, kHost_us + 20);
  EXPECT_EQ(taken(protocol).size(), 1u);
  EXPECT_NE(protocol.condition().text.find("reads /dev/ttyACM0 only"), std::string::npos);
}

TEST(GpsdProtocol, CountsWhatIsNoReport) {
  GpsdProtocol protocol = connected();
  protocol.receive("garbage\n" + std::string(40000, 'x') + "\n" + tpv(0), kHost_us + 20);
  EXPECT_EQ(protocol.counts().num_bad, 2);
  EXPECT_EQ(taken(protocol).size(), 1u);
}

template <class Report>
Report read(std::string_view line) {
  const GpsdReport report = parse_gpsd_report(line);
  EXPECT_TRUE(std::holds_alternative<Report>(report)) << line;
  const auto* found = std::get_if<Report>(&report);
  return found == nullptr ? Report{} : *found;
}

TEST(GpsdReport, ReadsAFix) {
  const auto fix = read<GpsdFix>(
      R"({"class":"TPV","device":"/dev/ttyACM0","status":3,"mode":3,)"
      R"("time":"2026-05-04T10:11:12.250Z","lat":-32.4,"lon":-71.3,"altHAE":51.5,"altMSL":41.5,)"
      R"("eph":0.02,"epx":1.5,"epy":1.6,"epv":2,"track":3.1,"ecefx":1e7})");
  EXPECT_EQ(fix.device, "/dev/ttyACM0");
  EXPECT_EQ(fix.mode, 3);
  EXPECT_EQ(fix.status, 3);
  EXPECT_EQ(fix.time_us, 1777889472250000);  // date -u -d 2026-05-04T10:11:12 +%s
  EXPECT_EQ(fix.latitude_deg, -32.4);
  EXPECT_EQ(fix.longitude_deg, -71.3);
  EXPECT_EQ(fix.altitude_m, 51.5);
  EXPECT_EQ(fix.eph_m, 0.02);
  EXPECT_EQ(fix.epv_m, 2.0);
}

TEST(GpsdReport, WhatIsNotSaidIsAbsent) {
  const auto fix = read<GpsdFix>(R"({"class":"TPV","mode":1})");
  EXPECT_EQ(fix.status, 0);
  EXPECT_FALSE(fix.time_us || fix.latitude_deg || fix.altitude_m || fix.eph_m);
}

TEST(GpsdReport, ReadsDeviationsDevicesAndErrors) {
  const auto noise = read<GpsdNoise>(
      R"({"class":"GST","device":"a","time":"2026-05-04T10:11:12.000Z","rms":0.5,"major":0.03,)"
      R"("minor":0.01,"orient":30.0,"lat":0.02,"lon":0.025,"alt":0.05})");
  EXPECT_EQ(noise.major_sd_m, 0.03);
  EXPECT_EQ(noise.orientation_deg, 30.0);
  EXPECT_EQ(noise.up_sd_m, 0.05);
  const auto devices = read<GpsdDevices>(
      R"({"class":"DEVICES","devices":[{"class":"DEVICE","path":"/dev/ttyACM0"},{"path":7}]})");
  EXPECT_EQ(devices.paths, std::vector<std::string>{"/dev/ttyACM0"});
  EXPECT_EQ(read<GpsdError>(R"({"class":"ERROR","message":"no"})").message, "no");
  read<GpsdOther>(R"({"class":"SKY","satellites":[{"PRN":1}]})");
  read<GpsdOther>(R"({"class":"VERSION","release":"3.22"})");
}

TEST(GpsdReport, RefusesWhatIsNone) {
  for (const char* line :
       {"", "{", "[]", "7", "null", "$GPGGA,1", R"({"class":"TPV")", R"({"mode":3})",
        R"({"class":"TPV","mode":4})", R"({"class":"TPV","mode":3,"lat":91})",
        R"({"class":"TPV","mode":3,"lat":"1"})", R"({"class":"TPV","mode":3,"lon":1e400})",
        R"({"class":"TPV","mode":3,"status":-1})",
        R"({"class":"TPV","mode":3,"status":99999999999})", R"({"class":"TPV","mode":3,"eph":-1})",
        R"({"class":"TPV","mode":3,"time":"yesterday"})", R"({"class":"TPV","mode":3,"lat":NaN})",
        R"({"class":7})"}) {
    EXPECT_TRUE(std::holds_alternative<GpsdBad>(parse_gpsd_report(line))) << line;
  }
  const std::string deep(100000, '[');
  EXPECT_TRUE(std::holds_alternative<GpsdBad>(parse_gpsd_report(deep)));
}

TEST(GpsdReport, TimesAreThoseOfTheCalendar) {
  // From `date -u -d ... +%s`.
  EXPECT_EQ(parse_utc("1970-01-01T00:00:00Z"), 0);
  EXPECT_EQ(parse_utc("2000-02-29T23:59:59.999Z"), 951868799999000);
  EXPECT_EQ(parse_utc("2024-03-01T00:00:00.0Z"), 1709251200000000);
  EXPECT_EQ(parse_utc("2100-03-01T12:00:00.123456789Z"), 4107585600123456);
  for (const char* text :
       {"", "Z", "2026-05-04", "2026-05-04T10:11:12", "2026-13-04T10:11:12Z",
        "2026-05-04T24:11:12Z", "2026-05-04T10:11:12.x5Z", "2026-05-04T10:11:12+Z",
        "2026-05-04 10:11:12Z", "1969-05-04T10:11:12Z", "2026-05-04T10:11:12.1234567890Z"}) {
    EXPECT_FALSE(parse_utc(text)) << text;
  }
}

}  // namespace

}  // namespace orchard::device
