// SPDX-License-Identifier: BSD-3-Clause
// What a live mapper costs as its drive goes on: gives one the SCAN and GNSS of a log and the
// messages that `orchard map` made of it (derived.lcm), saving its journal once a second of message
// time and the map's folder every five minutes of it, and prints the memory by tenths of the drive,
// per hour and per kilometre, the size of the journal, how long a commit holds it up at most, and
// how long one that is started again after a kill takes to be where this one was.
//   mapper_cost LOG DERIVED CONFIG OUT
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "bus/messages/codec.hpp"
#include "experiments/json_line.hpp"
#include "io/config/config.hpp"
#include "io/log/log_series.hpp"
#include "io/map/map_csv.hpp"
#include "mapper/mapper_process.hpp"

namespace {

using orchard::bus::Channel;

/// What the process holds in memory of its own, and with the pages of files [MB].
struct Memory {
  double own_mb = 0.0, with_files_mb = 0.0;
};

Memory memory() {
  Memory memory;
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("RssAnon:", 0) == 0) memory.own_mb = std::stod(line.substr(8)) / 1000.0;
    if (line.rfind("VmRSS:", 0) == 0) memory.with_files_mb = std::stod(line.substr(6)) / 1000.0;
  }
  return memory;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double processor_s() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto s = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return s(usage.ru_utime) + s(usage.ru_stime);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: mapper_cost LOG DERIVED CONFIG OUT\n");
    return 2;
  }
  const orchard::io::Config config = orchard::io::load_config(argv[3]);
  const std::string folder = argv[4];
  std::filesystem::remove_all(folder);
  const orchard::bus::Outbox nowhere = [](const orchard::bus::Message&) {};
  std::vector<Memory> course;
  double hours = 0.0, km = 0.0;
  std::string table;
  double longest_commit_s = 0.0, processor_of_drive_s = 0.0;
  {
    orchard::io::MapFolderLock place(folder);
    orchard::procs::JournaledMapper mapper(config, 1, place);
    mapper.start({});
    orchard::io::LogSeries logs(std::vector<std::string>{argv[1], argv[2]});
    orchard::procs::MapSaver saver(folder, 1);
    std::int64_t first_utime = 0, last_utime = 0, next_commit = 0, next_save = 0;
    double x_m = 0.0, y_m = 0.0;
    const double begun_s = processor_s();
    std::int64_t num = 0;
    while (const auto event = logs.next()) {
      const auto channel = orchard::bus::find_channel(event->channel);
      if (!channel) continue;
      bool is_input = false;
      for (const Channel input : mapper.inputs()) is_input = is_input || input == *channel;
      if (!is_input) continue;
      const auto decoded = orchard::bus::decode(*channel, event->data.data(), event->data.size());
      const auto* message = std::get_if<orchard::bus::Message>(&decoded);
      if (message == nullptr) continue;
      const std::int64_t utime = orchard::bus::utime_of(*message);
      if (const auto* pose = std::get_if<orchard::pose::PoseEstimate>(message)) {
        if (last_utime > 0) km += 1e-3 * std::hypot(pose->x_m - x_m, pose->y_m - y_m);
        x_m = pose->x_m;
        y_m = pose->y_m;
      }
      if (first_utime == 0) first_utime = utime;
      last_utime = std::max(last_utime, utime);
      mapper.handle(*message, nowhere);
      if (utime >= next_commit) {
        const auto begun = std::chrono::steady_clock::now();
        mapper.commit()();
        longest_commit_s = std::max(longest_commit_s, seconds_since(begun));
        next_commit = utime + 1000000;
      }
      if (utime >= next_save) {
        saver.save(mapper.mapper(), {orchard::bus::SaveKind::kFinal, {}})();
        next_save = utime + 300000000;
      }
      if (++num % 20000 == 0) course.push_back(memory());
    }
    course.push_back(memory());
    hours = 1e-6 * static_cast<double>(last_utime - first_utime) / 3600.0;
    processor_of_drive_s = processor_s() - begun_s;
    mapper.commit();
    table = orchard::io::map_csv(mapper.mapper().landmarks());
  }
  const std::size_t from = (course.size() - 1) / 10;
  const double part = 1.0 - static_cast<double>(from) / static_cast<double>(course.size() - 1);
  using orchard::procs::JournaledMapper;
  const double journal_mb =
      1e-6 *
      static_cast<double>(std::filesystem::file_size(folder + "/" + JournaledMapper::kJournalName));
  const auto start = std::chrono::steady_clock::now();
  const double begun_s = processor_s();
  orchard::io::MapFolderLock place(folder);
  JournaledMapper again(config, 1, place);
  again.start({});
  const double again_s = seconds_since(start);
  const bool is_same = orchard::io::map_csv(again.mapper().landmarks()) == table;
  orchard::trials::print_json(
      {{"hours", hours},
       {"km", km},
       {"processor_s", processor_of_drive_s},
       {"own_mb", course.back().own_mb},
       {"with_files_mb", course.back().with_files_mb},
       {"own_mb_per_hour", (course.back().own_mb - course[from].own_mb) / (part * hours)},
       {"journal_mb_per_km", journal_mb / km},
       {"commit_most_s", longest_commit_s},
       {"again_s", again_s},
       {"again_processor_s", processor_s() - begun_s},
       {"same", is_same}});
  return 0;
}
