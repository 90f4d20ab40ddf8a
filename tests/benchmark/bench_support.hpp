// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <string>
#include <vector>

#include "bus/messages/channel.hpp"
#include "io/config/config.hpp"

namespace orchard::bench {

/// A program that runs beside this one; killed when its owner ends without stop() or wait().
class ChildProcess {
 public:
  /// Starts a program with its standard output and error in a file. Throws std::runtime_error.
  ChildProcess(const std::vector<std::string>& arguments, const std::string& log_path);
  ~ChildProcess();
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;

  /// SIGINT, then its exit code (128 + signal when it was killed).
  int stop();
  /// SIGSTOP, SIGCONT ...
  void signal(int number);
  /// Waits for its end.
  int wait();

  /// User and system time of all its threads so far, in steps of 10 ms [s].
  double cpu_s() const;

  const std::string& name() const { return name_; }

 private:
  pid_t pid_ = -1;
  std::string name_;
};

/// The path of a program in build/bin.
std::string built_program(const std::string& name);
/// The path of the program that runs.
std::string this_program();

/// A folder that is removed with everything in it at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::string path(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

/// Moves this process, and every child it starts afterwards, into a network of its own: nothing
/// but lo, with multicast. To be called before any thread exists. Returns why it did not work, or
/// an empty text.
std::string enter_private_network();

/// A message of a source as it would stand on the wire.
struct RawMessage {
  std::int64_t utime = 0;
  bus::Channel channel = bus::Channel::kScan;
  std::vector<std::uint8_t> bytes;
};

/// A drive through the simulated orchard: scans at 10 Hz, 320 x 240 JPEGs at 10 Hz, odometry at
/// 50 Hz, and a fix of the position now and then.
struct FieldDrive {
  io::Config config;
  std::string config_path;  ///< the same for other processes
  std::string log_path;
  std::vector<RawMessage> messages;  ///< in the order of the log
  double duration_s = 0.0;
};

/// Simulates the drive and writes its log and configuration into a folder. `fix_rate_hz` is of
/// POSE_FIX. With `fixes_only` each fix is a pose (odometry serves the detector alone), and image
/// and scan have one time.
FieldDrive simulate_field_drive(const std::string& folder, double duration_s, double fix_rate_hz,
                                bool fixes_only);

/// Prints how many messages of which size the drive has.
void describe_drive(const FieldDrive& drive);

/// Starts orchard-detector, orchard-pose and orchard-mapper (which saves its map as in the field)
/// and returns when all three have been heard on the bus. Throws std::runtime_error when they are
/// not within 20 s.
std::vector<ChildProcess> start_live_pipeline(const std::string& config_path,
                                              const std::string& lcm_url,
                                              const TemporaryFolder& folder);

/// What a scan's place in the map needs, the picture last.
struct ScanSet {
  std::int64_t utime = 0;
  std::vector<const RawMessage*> inputs;
  std::uint32_t num_detector_inputs = 0;  ///< SCAN, ODOMETRY and IMAGE of them
};

/// One set per scan that has a picture, in order of time: the scan, everything of the wheels and of
/// the poses until the next scan begins (a sweep takes nearly as long, and its last object is
/// placed by the pose then), and the picture, which takes the longest to be compressed and sent.
/// `drive` outlives them.
std::vector<ScanSet> scan_sets(const FieldDrive& drive);

/// Sends what scans need and waits for their MAP.
class MapProbe {
 public:
  using Clock = std::chrono::steady_clock;

  /// `relayed`: MAP comes from a relay and begins with a RelayHeader.
  MapProbe(const std::string& url, bool relayed);

  void send(bus::Channel channel, const std::vector<std::uint8_t>& bytes);

  /// Milliseconds since the picture was sent; negative when no MAP comes within the time.
  double wait_for_map(std::int64_t utime, Clock::time_point until);

  /// Both for a set as it is.
  double through(const ScanSet& set, Clock::time_point until);

 private:
  void on_map(const lcm::ReceiveBuffer* buffer, const std::string&);

  lcm::LCM lcm_;
  bool relayed_;
  Clock::time_point sent_;
  Clock::time_point received_;
  std::int64_t utime_ = 0;
};

/// The same hops as detector, pose and mapper, of processes that compute nothing: bare LCM with raw
/// handlers. A set of messages travels as  SCAN, ODOMETRY, IMAGE -> DETECTIONS,  POSE_FIX -> POSE,
/// DETECTIONS and POSE -> MAP;  each starts with a RelayHeader and is filled up to its real size.
struct RelayHeader {
  std::int64_t utime = 0;
  std::uint32_t num_detector_inputs = 0;  ///< SCAN, ODOMETRY and IMAGE of the set
  std::uint32_t detections_bytes = 0;     ///< size that the DETECTIONS of this set is to have
  std::uint32_t pose_bytes = 0;
  std::uint32_t map_bytes = 0;
};

/// The three processes; they are this program with other arguments. Returns when each of them
/// answers. Throws std::runtime_error when one does not.
std::vector<ChildProcess> start_relays(const std::string& lcm_url, const TemporaryFolder& folder);

bool is_relay(int argc, char** argv);
int run_relay(char** argv);

/// Plays a log with lcm-logplayer --speed=0 on the URL and returns how many of its messages a plain
/// LCM subscriber, a process of its own, got. `queue_capacity` is of its subscription; 0 = no
/// limit.
std::int64_t count_played(const std::string& log_path, const std::string& lcm_url,
                          int queue_capacity, const TemporaryFolder& folder);

/// The subscriber's process is this program with other arguments.
bool is_counter(int argc, char** argv);
int run_counter(char** argv);

}  // namespace orchard::bench
