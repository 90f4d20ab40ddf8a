// SPDX-License-Identifier: BSD-3-Clause
#include "system/real_recordings/altered_drive.hpp"
#include "geometry/pose2.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "geometry/angles.hpp"
#include "simulation/random.hpp"

namespace orchard::test {
namespace {

using simulation::Random;
using simulation::Stream;

void set_utime(Station& station, std::int64_t utime) {
  station.scan.utime = station.track.utime = utime;
  if (station.fix) station.fix->utime = utime;
}

void as_it_is(AlteredDrive&, std::uint64_t) {}

void backwards(AlteredDrive& drive, std::uint64_t) {
  const std::int64_t ends = drive.front().scan.utime + drive.back().scan.utime;
  for (Station& s : drive) set_utime(s, ends - s.scan.utime);
  std::reverse(drive.begin(), drive.end());
}

void there_and_back(AlteredDrive& drive, std::uint64_t seed) {
  AlteredDrive back = drive;
  backwards(back, seed);
  const std::int64_t later = drive.back().scan.utime - drive.front().scan.utime;
  for (std::size_t i = 1; i < back.size(); ++i) {  // the turning point is seen once
    set_utime(back[i], back[i].scan.utime + later);
    drive.push_back(back[i]);
  }
}

void mirrored(AlteredDrive& drive, std::uint64_t) {
  for (Station& s : drive) {
    laser::Scan& scan = s.scan;
    scan.bearing_min_rad = -scan.bearing_rad(static_cast<double>(scan.ranges_m.size()) - 1.0);
    std::reverse(scan.ranges_m.begin(), scan.ranges_m.end());
    std::reverse(scan.intensities.begin(), scan.intensities.end());
    for (pose::PoseFix* fix : {&s.track, &*s.fix}) {
      fix->y_m = -fix->y_m;
      fix->yaw_rad = -fix->yaw_rad;
    }
  }
}

/// Keeps the stations whose index `keep` accepts.
template <class Keep>
void keep_if(AlteredDrive& drive, const Keep& keep) {
  AlteredDrive kept;
  for (std::size_t i = 0; i < drive.size(); ++i) {
    if (keep(i)) kept.push_back(std::move(drive[i]));
  }
  drive = std::move(kept);
}

void thinned(AlteredDrive& drive, std::uint64_t) {
  keep_if(drive, [](std::size_t i) { return i % 2 == 0; });
}

void scans_lost(AlteredDrive& drive, std::uint64_t seed) {
  Random random(seed, Stream::kScan);
  keep_if(drive, [&](std::size_t) { return random.uniform() >= 0.12; });
}

void first_half(AlteredDrive& drive, std::uint64_t) { drive.resize((drive.size() + 1) / 2); }

void second_half(AlteredDrive& drive, std::uint64_t) {
  keep_if(drive, [from = drive.size() / 2](std::size_t i) { return i >= from; });
}

void middle_half(AlteredDrive& drive, std::uint64_t) {
  keep_if(drive, [num = drive.size()](std::size_t i) { return 4 * i >= num && 4 * i < 3 * num; });
}

void true_speed(AlteredDrive& drive, std::uint64_t) {
  const std::int64_t start = drive.front().scan.utime;
  for (Station& s : drive) set_utime(s, start + (s.scan.utime - start) / 36);
}

void noisier(AlteredDrive& drive, std::uint64_t seed) {
  Random random(seed, Stream::kScan);
  for (Station& s : drive) {
    for (float& range_m : s.scan.ranges_m) {
      if (range_m > 0.0f)
        range_m = std::max(0.01f, range_m + static_cast<float>(random.normal(0.0, 0.03)));
    }
  }
}

void returns_lost(AlteredDrive& drive, std::uint64_t seed) {
  Random random(seed, Stream::kScan);
  for (Station& s : drive) {
    for (float& range_m : s.scan.ranges_m) {
      if (random.uniform() < 0.05) range_m = 0.0f;
    }
  }
}

void track_moved(AlteredDrive& drive, std::uint64_t) {
  const Eigen::Vector3d T_other_map(40.0, -25.0, 2.0);
  for (Station& s : drive) {
    for (pose::PoseFix* fix : {&s.track, &*s.fix}) {
      const Eigen::Vector3d moved =
          geometry::compose(T_other_map, {fix->x_m, fix->y_m, fix->yaw_rad});
      fix->x_m = moved.x();
      fix->y_m = moved.y();
      fix->yaw_rad = moved.z();
    }
  }
}

void headings_off(AlteredDrive& drive, std::uint64_t) {
  for (Station& s : drive) s.fix->yaw_rad = geometry::wrap_angle_rad(s.fix->yaw_rad + 0.17);
}

void track_gaps(AlteredDrive& drive, std::uint64_t seed) {
  Random random(seed, Stream::kGnss);
  const std::size_t gap = drive.size() / 10;
  for (int k = 0; k < 4; ++k) {
    const auto from =
        static_cast<std::size_t>(random.uniform(0.02, 0.9) * static_cast<double>(drive.size()));
    for (std::size_t i = from; i < std::min(from + gap, drive.size()); ++i) drive[i].fix.reset();
  }
}

void track_drifts(AlteredDrive& drive, std::uint64_t seed) {
  Random random(seed, Stream::kGnss);
  constexpr double kSd_m = 0.2, kForgotten = 1.0 / 36.0;  // alike over some 36 scans: 10 m
  Eigen::Vector2d off(random.normal(0.0, kSd_m), random.normal(0.0, kSd_m));
  for (Station& s : drive) {
    const double step_m = kSd_m * std::sqrt(2.0 * kForgotten);
    off = (1.0 - kForgotten) * off +
          Eigen::Vector2d(random.normal(0.0, step_m), random.normal(0.0, step_m));
    s.fix->x_m += off.x() + random.normal(0.0, 0.05);
    s.fix->y_m += off.y() + random.normal(0.0, 0.05);
  }
}

void track_jumps(AlteredDrive& drive, std::uint64_t seed) {
  Random random(seed, Stream::kGnssJump);
  for (Station& s : drive) {
    if (random.uniform() >= 0.03) continue;
    s.fix->x_m += random.uniform(-3.0, 3.0);
    s.fix->y_m += random.uniform(-3.0, 3.0);
  }
}

}  // namespace

const std::vector<Alteration>& alterations() {
  static const std::vector<Alteration> all{
      {"as_it_is", "the drive itself", as_it_is},
      {"backwards", "the last scan first", backwards},
      {"there_and_back", "the drive, then the same backwards", there_and_back, 2.0},
      {"mirrored", "left is right", mirrored},
      {"thinned", "every second scan", thinned, 0.5},
      {"scans_lost", "12 % of the scans lost", scans_lost, 0.88},
      {"first_half", "ends half way", first_half},
      {"second_half", "starts half way", second_half},
      {"middle_half", "starts after a quarter, ends after three", middle_half},
      {"true_speed", "time stamps 36 times as fast: 1 m/s", true_speed},
      {"noisier", "ranges 0.03 m noisier", noisier},
      {"returns_lost", "5 % of the beams return nothing", returns_lost},
      {"track_moved", "the track in another frame: 47 m away, turned by 115 degrees", track_moved},
      {"headings_off", "the track's headings 10 degrees off", headings_off},
      {"track_gaps", "no fixes over up to four tenths of the drive", track_gaps},
      {"track_drifts", "the track 0.2 m off, alike over 10 m, and 0.05 m of noise", track_drifts},
      {"track_jumps", "3 % of the fixes up to 3 m off", track_jumps},
  };
  return all;
}

const Alteration* find_alteration(const std::string& name) {
  const auto found = std::find_if(alterations().begin(), alterations().end(),
                                  [&](const Alteration& a) { return name == a.name; });
  return found == alterations().end() ? nullptr : &*found;
}

AlteredDrive alter(const std::vector<io::SensorMessage>& recording, const Alteration& alteration,
                   std::uint64_t seed) {
  std::map<std::int64_t, pose::PoseFix> fixes;
  for (const io::SensorMessage& message : recording) {
    if (const auto* fix = std::get_if<pose::PoseFix>(&message)) fixes[fix->utime] = *fix;
  }
  AlteredDrive drive;
  for (const io::SensorMessage& message : recording) {
    const auto* scan = std::get_if<laser::Scan>(&message);
    if (scan == nullptr) continue;
    const auto fix = fixes.find(scan->utime);
    if (fix != fixes.end()) drive.push_back({*scan, fix->second, fix->second});
  }
  if (!drive.empty()) alteration.apply(drive, seed);
  return drive;
}

std::vector<io::SensorMessage> messages_of(const AlteredDrive& drive) {
  std::vector<io::SensorMessage> messages;
  for (const Station& s : drive) {
    messages.push_back(s.scan);
    if (s.fix) messages.push_back(*s.fix);
  }
  io::sort_and_number(messages);
  return messages;
}

std::vector<io::SensorMessage> tracked_messages_of(const AlteredDrive& drive) {
  std::vector<io::SensorMessage> messages;
  for (const Station& s : drive) {
    messages.push_back(s.scan);
    messages.push_back(s.track);
  }
  io::sort_and_number(messages);
  return messages;
}

}  // namespace orchard::test
