// SPDX-License-Identifier: BSD-3-Clause
// How well the tilt of a robot is known from the IMU and ODOMETRY of a log, against its true poses:
// the error of roll and pitch, and what it is over the claimed standard deviation, squared, in the
// mean (1 if that is true).
//   attitude_trials LOG POSES
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "bus/messages/codec.hpp"
#include "experiments/json_line.hpp"
#include "io/csv.hpp"
#include "io/log/log_series.hpp"
#include "pose/attitude/attitude_filter.hpp"

namespace {

using orchard::bus::Channel;

constexpr std::int64_t kSettled_us = 10'000'000;  // derived: ten means of the force

struct Truth {
  double roll_rad, pitch_rad;
};

std::map<std::int64_t, Truth> true_tilts(const std::string& path) {
  orchard::io::CsvReader csv = orchard::io::CsvReader::open(path);
  const auto& names = csv.columns();
  const auto column = [&](const char* name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  const std::size_t roll = column("roll_rad"), pitch = column("pitch_rad");
  std::map<std::int64_t, Truth> tilts;
  const bool is_level =
      roll == names.size() || pitch == names.size();  // as level drives are written
  while (csv.next()) {
    tilts[csv.integer(0)] = is_level ? Truth{0.0, 0.0} : Truth{csv.number(roll), csv.number(pitch)};
  }
  return tilts;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: attitude_trials LOG POSES\n");
    return 2;
  }
  const std::map<std::int64_t, Truth> truth = true_tilts(argv[2]);
  orchard::io::LogSeries logs(std::vector<std::string>{argv[1]});
  orchard::pose::AttitudeFilter filter;
  double squares = 0.0, over_claim = 0.0;
  int num = 0;
  while (const auto event = logs.next()) {
    const auto channel = orchard::bus::find_channel(event->channel);
    if (channel != Channel::kImu && channel != Channel::kOdometry) continue;
    const auto decoded = orchard::bus::decode(*channel, event->data.data(), event->data.size());
    const auto* message = std::get_if<orchard::bus::Message>(&decoded);
    if (message == nullptr) continue;
    if (const auto* odometry = std::get_if<orchard::pose::Odometry>(message)) filter.add(*odometry);
    const auto* imu = std::get_if<orchard::pose::Imu>(message);
    if (imu == nullptr) continue;
    filter.add(*imu);
    const auto of_then = truth.find(imu->utime);
    if (of_then == truth.end() || imu->utime - truth.begin()->first < kSettled_us) continue;
    const auto told = filter.at(imu->utime);
    const double roll = told->roll_rad - of_then->second.roll_rad;
    const double pitch = told->pitch_rad - of_then->second.pitch_rad;
    squares += 0.5 * (roll * roll + pitch * pitch);
    over_claim += 0.5 * (roll * roll + pitch * pitch) / (told->sd_rad * told->sd_rad);
    ++num;
  }
  if (num == 0) {
    std::fprintf(stderr, "attitude_trials: no IMU of %s after 10 s has a pose in %s\n", argv[1],
                 argv[2]);
    return 1;
  }
  orchard::trials::print_json(
      {{"num", num}, {"rms_rad", std::sqrt(squares / num)}, {"over_claim", over_claim / num}});
  return 0;
}
