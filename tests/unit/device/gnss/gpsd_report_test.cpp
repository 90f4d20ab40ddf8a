// SPDX-License-Identifier: BSD-3-Clause
// Reports as gpsd_json(5) describes them.
#include "device/gnss/gpsd_report.hpp"

#include <gtest/gtest.h>

namespace orchard::device {
namespace {

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
