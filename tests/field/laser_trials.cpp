// SPDX-License-Identifier: BSD-3-Clause
//
// laser_trials TRIAL ...: what becomes of a scanner's sweeps and stamps, over real connections and
// in real time. Prints "name value" lines.
//   unplug tcp|pty NUM SEED     pulls the cable out NUM times; seconds from plugging in to a scan
//   stamps SECONDS LOAD SKEW_PPM   stamps less the truth, the clock wrapping in the middle, beside
//                               LOAD processes that never rest
//   sums NUM PERCENT SEED       sweeps of which some have a wrong sum, in simulated time
//   serve WHERE                 an emulated scanner, until it is killed
//   watch DEVICE                a driver, until it is killed: a line "scan SECONDS" for each scan
//   bearings                    against the formula of the specification, every model
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "bus/node/process_report.hpp"
#include "device/emulated/emulated_laser.hpp"
#include "device/scip/scip_protocol.hpp"
#include "node/drivers/driven_laser.hpp"
#include "unit/device/simulated_line.hpp"

namespace orchard {
namespace {

using Clock = bus::Driver::Clock;

std::unique_ptr<device::EmulatedDevice> hokuyo(std::int64_t on_for_us, double skew = 0.0) {
  return std::make_unique<device::ScipDevice>(
      device::ust_10lx(), device::EmulatedClock{bus::wall_utime() - on_for_us, skew});
}

int unplug(const std::string& line, int num, unsigned seed) {
  const std::string where =
      line == "tcp" ? "tcp:127.0.0.1:0" : "pty:/tmp/laser_trial_" + std::to_string(getpid());
  DrivenLaser laser(std::make_unique<device::ScipProtocol>(), hokuyo(60'000'000), where,
                    field_scanner());
  if (!laser.run_until([&] { return laser.scans().size() >= 20; })) return 1;
  std::mt19937 random(seed);
  std::vector<double> waits_s;
  for (int i = 0; i < num; ++i) {
    laser.server().unplug();
    // From a loose contact to a walk to the robot; every second time its power was cut, too.
    const auto out = std::chrono::milliseconds(50 + random() % 2500);
    const Clock::time_point in = Clock::now() + out;
    laser.run_until([&] { return Clock::now() >= in; });
    if (i % 2 == 1) laser.server().replace(hokuyo(0));
    laser.server().plug_in();
    const Clock::time_point begin = Clock::now();
    const std::size_t before = laser.scans().size();
    if (!laser.run_until([&] { return laser.scans().size() > before; })) return 1;
    waits_s.push_back(std::chrono::duration<double>(Clock::now() - begin).count());
    const std::size_t enough = laser.scans().size() + 10;
    if (!laser.run_until([&] { return laser.scans().size() >= enough; })) return 1;
  }
  int num_wrong = 0;
  double worst_us = 0.0;
  for (const laser::Scan& scan : laser.scans()) {
    const double error_us = static_cast<double>(scan.utime - laser.true_utime(scan));
    worst_us = std::max(worst_us, std::abs(error_us));
    num_wrong += std::count(scan.ranges_m.begin(), scan.ranges_m.end(), scan.ranges_m[0]) != 1081;
  }
  double mean_s = 0.0;
  for (const double wait_s : waits_s) mean_s += wait_s / num;
  std::printf("replugs %d\nworst_s %.3f\nmean_s %.3f\nwrong %d\nworst_stamp_ms %.2f\n", num,
              *std::max_element(waits_s.begin(), waits_s.end()), mean_s, num_wrong,
              1e-3 * worst_us);
  return 0;
}

/// Never rests, and dies with its parent.
void spin_forever() {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  volatile double sum = 0.0;
  while (true) sum = sum + 1.0;
}

/// The scanner's side, in a process of its own.
[[noreturn]] void serve(bus::DeviceServer& server, std::int64_t begin_utime) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  laser::Scan scan = field_scanner();
  for (std::int64_t next = 0;;) {
    std::vector<pollfd> files = server.files();
    const auto begin =
        Clock::now() + std::chrono::microseconds(begin_utime + next * 25'000 - server.now());
    const auto due = std::min(begin, server.deadline());
    const auto left = std::chrono::duration_cast<std::chrono::nanoseconds>(due - Clock::now());
    const std::int64_t ns = std::clamp<std::int64_t>(left.count(), 0, 100'000'000);
    const timespec wait{0, static_cast<long>(ns)};
    ppoll(files.data(), files.size(), &wait, nullptr);
    for (; begin_utime + next * 25'000 <= server.now(); ++next) {
      scan.utime = begin_utime + next * 25'000;
      for (float& range_m : scan.ranges_m) {
        range_m = static_cast<float>(1e-3 * static_cast<double>(1000 + next % 20'000));
      }
      server.measured(scan);
    }
    server.step();
  }
}

int watch(const std::string& where) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  bus::StreamDriver driver(std::make_unique<device::ScipProtocol>(), bus::parse_port(where));
  while (true) {
    std::vector<pollfd> files = driver.files();
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(driver.deadline() - Clock::now()).count();
    poll(files.data(), files.size(), static_cast<int>(std::clamp<std::int64_t>(left, 0, 100)));
    driver.step([](const bus::Message&) {
      const std::chrono::duration<double> now = Clock::now().time_since_epoch();
      std::printf("scan %.4f\n", now.count());
      std::fflush(stdout);
    });
  }
}

int stamps(double seconds, int load, double skew) {
  constexpr std::int64_t kWrap_us = (std::int64_t{1} << 24) * 1000;
  const auto half_us = static_cast<std::int64_t>(0.5e6 * seconds);
  bus::DeviceServer server(hokuyo(kWrap_us - half_us, skew), "tcp:127.0.0.1:0");
  const std::int64_t begin_utime = server.now();
  std::vector<pid_t> children;
  for (int i = 0; i < load; ++i) {
    children.push_back(fork());
    if (children.back() == 0) spin_forever();
  }
  children.push_back(fork());
  if (children.back() == 0) serve(server, begin_utime);
  bus::StreamDriver driver(std::make_unique<device::ScipProtocol>(),
                           bus::parse_port(server.address()));
  std::vector<double> errors_us;
  const Clock::time_point end =
      Clock::now() + std::chrono::milliseconds(static_cast<std::int64_t>(1000 * seconds));
  while (Clock::now() < end) {
    std::vector<pollfd> files = driver.files();
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(driver.deadline() - Clock::now()).count();
    poll(files.data(), files.size(), static_cast<int>(std::clamp<std::int64_t>(left, 0, 100)));
    driver.step([&](bus::Message message) {
      const auto* scan = std::get_if<laser::Scan>(&message);
      if (scan == nullptr) return;
      const auto index = std::lround(static_cast<double>(scan->utime - begin_utime) / 25e3);
      errors_us.push_back(static_cast<double>(scan->utime - begin_utime - index * 25'000));
      // A stamp that is off by a whole sweep or more would be nearest to another one's truth.
      const auto sent = std::lround(1e3 * static_cast<double>(scan->ranges_m[0])) - 1000;
      if ((index % 20'000) != sent) errors_us.back() += 25e3 * static_cast<double>(index - sent);
    });
  }
  for (const pid_t child : children) kill(child, SIGKILL);
  for (const pid_t child : children) waitpid(child, nullptr, 0);
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const double cpu_s = static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
                       1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
  if (errors_us.size() < 100) return 1;
  double mean = 0.0;
  double squares = 0.0;
  double worst = 0.0;
  const auto n = static_cast<double>(errors_us.size());
  for (const double error : errors_us) mean += error / n;
  for (const double error : errors_us) {
    squares += (error - mean) * (error - mean) / n;
    worst = std::max(worst, std::abs(error));
  }
  std::printf(
      "sweeps %zu\nexpected %.0f\nmean_ms %.3f\nsd_ms %.3f\nworst_ms %.3f\ncpu_percent %.2f\n",
      errors_us.size(), seconds * 40.0, 1e-3 * mean, 1e-3 * std::sqrt(squares), 1e-3 * worst,
      100.0 * cpu_s / seconds);
  return 0;
}

int sums(int num, double percent, unsigned seed) {
  constexpr std::int64_t kNoon = 1'700'000'000'000'000;
  device::ScipProtocol protocol;
  device::ScipDevice device(device::ust_10lx(), {kNoon - 60'000'000, 0.0});
  device::SimulatedLine line(protocol, device, kNoon, seed);
  line.connect();
  line.run_until(kNoon + 200'000);
  std::mt19937 random(seed);
  int num_spoilt = 0;
  line.spoil = [&](std::string& bytes) {
    if (static_cast<double>(random() % 100'000) >= 1000.0 * percent) return;
    std::vector<std::size_t> sums;  // the character before each end of a line, but for the echo's
    for (std::size_t i = bytes.find('\n') + 1; (i = bytes.find('\n', i)) != std::string::npos;
         ++i) {
      if (bytes[i - 1] != '\n') sums.push_back(i - 1);
    }
    char& sum = bytes[sums[random() % sums.size()]];
    sum = static_cast<char>('0' + (sum - '0' + 1 + static_cast<int>(random() % 63)) % 64);
    ++num_spoilt;
  };
  laser::Scan scan = field_scanner();
  int num_wrong = 0;
  int num_out = 0;
  for (int i = 0; i < num; ++i) {
    scan.utime = kNoon + 200'000 + i * 25'000;
    line.run_until(scan.utime);
    for (std::size_t b = 0; b < scan.ranges_m.size(); ++b) {
      const std::size_t mm = 100 + (static_cast<std::size_t>(i) * 7 + b * 13) % 29'000;
      scan.ranges_m[b] = static_cast<float>(1e-3 * static_cast<double>(mm));
    }
    device.measured(scan);
    for (const device::Measurement& m : protocol.take_measurements()) {
      const auto& out = std::get<laser::Scan>(m);
      const auto index = std::lround(static_cast<double>(out.utime - kNoon - 200'000) / 25e3);
      ++num_out;
      for (std::size_t b = 0; b < out.ranges_m.size(); ++b) {
        const std::size_t mm = 100 + (static_cast<std::size_t>(index) * 7 + b * 13) % 29'000;
        if (out.ranges_m[b] != static_cast<float>(1e-3 * static_cast<double>(mm))) ++num_wrong;
      }
    }
  }
  std::printf("sweeps %d\nspoilt %d\npublished %d\nwrong_beams %d\ncounted_bad %lld\n", num,
              num_spoilt, num_out, num_wrong, static_cast<long long>(protocol.counts().num_bad));
  return 0;
}

int bearings() {
  constexpr std::int64_t kNoon = 1'700'000'000'000'000;
  double worst_rad = 0.0;
  for (const device::ScipModel& m :
       {device::urg_04lx_ug01(), device::utm_30lx(), device::ust_10lx()}) {
    device::ScipProtocol protocol;
    device::ScipDevice device(m, {kNoon - 60'000'000, 0.0});
    device::SimulatedLine line(protocol, device, kNoon, 1);
    line.connect();
    line.run_until(kNoon + 200'000);
    laser::Scan scan = field_scanner();
    scan.utime = kNoon + 200'000;
    std::fill(scan.ranges_m.begin(), scan.ranges_m.end(), 1.0f);
    device.measured(scan);
    line.run_until(kNoon + 400'000);
    const auto measured = protocol.take_measurements();
    if (measured.size() != 1) return 1;
    const auto& out = std::get<laser::Scan>(measured[0]);
    if (static_cast<int>(out.ranges_m.size()) != m.last_step - m.first_step + 1) return 1;
    for (int step = m.first_step; step <= m.last_step; ++step) {
      const double formula_rad = 2.0 * M_PI * (step - m.front_step) / m.steps_per_turn;
      worst_rad = std::max(worst_rad, std::abs(out.bearing_rad(step - m.first_step) - formula_rad));
    }
  }
  std::printf("worst_rad %.1e\n", worst_rad);
  return 0;
}

}  // namespace
}  // namespace orchard

int main(int argc, char** argv) {
  const std::string trial = argc > 1 ? argv[1] : "";
  if (trial == "unplug" && argc == 5) {
    return orchard::unplug(argv[2], std::atoi(argv[3]), static_cast<unsigned>(std::atoi(argv[4])));
  }
  if (trial == "stamps" && argc == 5) {
    return orchard::stamps(std::atof(argv[2]), std::atoi(argv[3]), 1e-6 * std::atof(argv[4]));
  }
  if (trial == "sums" && argc == 5) {
    return orchard::sums(std::atoi(argv[2]), std::atof(argv[3]),
                         static_cast<unsigned>(std::atoi(argv[4])));
  }
  if (trial == "serve" && argc == 3) {
    orchard::bus::DeviceServer server(orchard::hokuyo(60'000'000), argv[2]);
    orchard::serve(server, server.now());
  }
  if (trial == "watch" && argc == 3) return orchard::watch(argv[2]);
  if (trial == "bearings") return orchard::bearings();
  std::fprintf(stderr, "laser_trials: see the head of laser_trials.cpp\n");
  return 2;
}
