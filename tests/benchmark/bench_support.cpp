// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/bench_support.hpp"

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <utility>
#include <variant>

#include "bus/bus.hpp"
#include "bus/messages/codec.hpp"
#include "io/log/log_writer.hpp"
#include "simulation/simulator.hpp"

namespace orchard::bench {
namespace {

/// A plain user is root of a user namespace and may then have a network.
bool enter_as_plain_user() {
  const std::string uid = std::to_string(getuid());
  const std::string gid = std::to_string(getgid());
  if (unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) return false;
  std::ofstream("/proc/self/setgroups") << "deny";
  std::ofstream("/proc/self/uid_map") << "0 " << uid << " 1";
  std::ofstream("/proc/self/gid_map") << "0 " << gid << " 1";
  return true;
}

using bus::Channel;

std::string name_of(Channel channel) { return std::string(bus::info(channel).name); }

std::vector<const RawMessage*> messages_of(const FieldDrive& drive, Channel channel) {
  std::vector<const RawMessage*> messages;
  for (const RawMessage& message : drive.messages) {
    if (message.channel == channel) messages.push_back(&message);
  }
  return messages;
}

constexpr const char* kRelayFlag = "--relay";

class Relay {
 public:
  Relay(lcm::LCM& lcm, const std::string& role) : lcm_(lcm) {
    const auto listen = [this](const char* channel) {
      lcm_.subscribe(channel, &Relay::take, this)->setQueueCapacity(0);
    };
    if (role == "detector") {
      listen("SCAN");
      listen("ODOMETRY");
      listen("IMAGE");
    } else if (role == "pose") {
      listen("POSE_FIX");
    } else {
      listen("DETECTIONS");
      listen("POSE");
    }
    role_ = role;
  }

 private:
  /// Sends on when every message of a set is there.
  void take(const lcm::ReceiveBuffer* buffer, const std::string&) {
    RelayHeader header;
    if (buffer->data_size < sizeof header) return;
    std::memcpy(&header, buffer->data, sizeof header);
    num_of_set_ = header.utime == utime_ ? num_of_set_ + 1 : 1;
    utime_ = header.utime;
    if (num_of_set_ < needed(header)) return;
    if (role_ == "detector") return send("DETECTIONS", header, header.detections_bytes);
    if (role_ == "pose") return send("POSE", header, header.pose_bytes);
    send("MAP", header, header.map_bytes);
  }

  std::uint32_t needed(const RelayHeader& header) const {
    if (role_ == "detector") return header.num_detector_inputs;
    return role_ == "pose" ? 1 : 2;
  }

  void send(const char* channel, const RelayHeader& header, std::uint32_t size) {
    std::vector<std::uint8_t> bytes(std::max<std::size_t>(size, sizeof header));
    std::memcpy(bytes.data(), &header, sizeof header);
    lcm_.publish(channel, bytes.data(), static_cast<unsigned int>(bytes.size()));
  }

  lcm::LCM& lcm_;
  std::string role_;
  std::int64_t utime_ = -1;
  std::uint32_t num_of_set_ = 0;
};

bool is_ready(const std::string& path) {
  std::ifstream file(path);
  std::string word;
  return file >> word && word == "ready";
}

constexpr const char* kCounterFlag = "--count-messages";

volatile sig_atomic_t stop_asked = 0;

struct Counter {
  void count(const lcm::ReceiveBuffer*, const std::string&) { ++num_received; }
  long long num_received = 0;
};

/// The number after a word in the counter's output so far, or -1.
std::int64_t number_after(const std::string& path, const std::string& word) {
  std::ifstream file(path);
  std::string found;
  std::int64_t number = 0;
  while (file >> found >> number) {
    if (found == word) return number;
  }
  return -1;
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& arguments, const std::string& log_path)
    : name_(std::filesystem::path(arguments.at(0)).filename().string()) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log_path.c_str(),
                                   O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  // This program may have blocked the signals that are to end the child.
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const int error = posix_spawnp(&pid_, argv[0], &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw std::runtime_error(arguments[0] + ": " + std::strerror(error));
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)), name_(std::move(other.name_)) {}

ChildProcess::~ChildProcess() {
  if (pid_ < 0) return;
  kill(pid_, SIGKILL);
  wait();
}

int ChildProcess::stop() {
  if (pid_ > 0) kill(pid_, SIGINT);
  return wait();
}

void ChildProcess::signal(int number) {
  if (pid_ > 0) kill(pid_, number);
}

int ChildProcess::wait() {
  int status = 0;
  if (pid_ < 0 || waitpid(std::exchange(pid_, -1), &status, 0) < 0) return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

double ChildProcess::cpu_s() const {
  std::ifstream file("/proc/" + std::to_string(pid_) + "/stat");
  std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  // The second field is the name in parentheses, and may hold anything.
  std::istringstream fields(text.substr(text.rfind(')') + 1));
  std::string word;
  for (int i = 3; i < 14; ++i) fields >> word;
  double user_ticks = 0.0, system_ticks = 0.0;
  fields >> user_ticks >> system_ticks;
  return (user_ticks + system_ticks) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

std::string this_program() { return std::filesystem::read_symlink("/proc/self/exe").string(); }

std::string built_program(const std::string& name) {
  return std::filesystem::path(this_program()).parent_path().parent_path() / "bin" / name;
}

TemporaryFolder::TemporaryFolder() {
  path_ = (std::filesystem::temp_directory_path() / "orchard_bench_XXXXXX").string();
  if (mkdtemp(path_.data()) == nullptr) throw std::runtime_error("no temporary folder");
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string enter_private_network() {
  if (unshare(CLONE_NEWNET) != 0 && !enter_as_plain_user()) {
    return std::string("the kernel refuses a network namespace (") + std::strerror(errno) + ")";
  }
  const int status = std::system(
      "ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo");
  return status == 0 ? "" : "ip could not make a multicast route on lo";
}

FieldDrive simulate_field_drive(const std::string& folder, double duration_s, double fix_rate_hz,
                                bool fixes_only) {
  FieldDrive drive;
  drive.config = io::load_config(ORCHARD_SOURCE_DIR "/config/orchard.yaml");
  simulation::SimulationConfig& simulation = drive.config.simulation;
  simulation.motion.gnss_rate_hz = 0.0;
  simulation.orchard.fix_rate_hz = fix_rate_hz;
  if (fixes_only) {
    drive.config.pose.mode = pose::PoseMode::kFixes;
    simulation.image.offset_s = 0.0;
  }
  drive.config_path = folder + "/rig.yaml";
  std::ofstream(drive.config_path) << io::print_config(drive.config);

  const simulation::RigConfig rig{drive.config.laser, drive.config.camera, simulation, {}};
  simulation::Simulator simulator(simulation::SceneKind::kOrchard, 1, rig);
  drive.log_path = folder + "/drive.lcm";
  io::LogWriter writer(drive.log_path);
  while (const auto sensed = simulator.next()) {
    const bus::Message message = std::visit([](const auto& m) { return bus::Message(m); }, *sensed);
    const std::int64_t utime = bus::utime_of(message);
    const double time_s = 1e-6 * static_cast<double>(utime - simulation::kEpochUtime);
    if (time_s > duration_s) break;
    drive.duration_s = time_s;
    drive.messages.push_back({utime, bus::channel_of(message), bus::encode(message)});
    writer.write(utime, bus::info(bus::channel_of(message)).name, drive.messages.back().bytes);
  }
  writer.close();
  return drive;
}

void describe_drive(const FieldDrive& drive) {
  std::map<bus::Channel, std::pair<int, std::size_t>> counts;
  for (const RawMessage& message : drive.messages) {
    ++counts[message.channel].first;
    counts[message.channel].second += message.bytes.size();
  }
  std::printf("a drive of %.1f s through the simulated orchard:", drive.duration_s);
  for (const auto& [channel, count] : counts) {
    std::printf(" %d %s of %zu bytes;", count.first, std::string(bus::info(channel).name).c_str(),
                count.second / static_cast<std::size_t>(count.first));
  }
  std::printf("\n");
  std::fflush(stdout);
}

std::vector<ChildProcess> start_live_pipeline(const std::string& config_path,
                                              const std::string& lcm_url,
                                              const TemporaryFolder& folder) {
  const std::set<std::string> names{"orchard-detector", "orchard-pose", "orchard-mapper"};
  std::set<std::string> missing = names;
  bus::Bus bus(lcm_url);
  bus.subscribe_status([&missing](const bus::Status& heard) { missing.erase(heard.name); });
  std::vector<ChildProcess> processes;
  for (const std::string& name : names) {
    std::vector<std::string> arguments{built_program(name), "--config", config_path, "--lcm-url",
                                       lcm_url};
    if (name == "orchard-mapper") {
      arguments.insert(arguments.end(), {"--out", folder.path("map")});
    }
    processes.emplace_back(arguments, folder.path(name + ".log"));
  }
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!missing.empty()) {
    if (std::chrono::steady_clock::now() > end) {
      throw std::runtime_error(*missing.begin() + " was not heard on the bus");
    }
    bus.handle(100);
  }
  return processes;
}

std::vector<ScanSet> scan_sets(const FieldDrive& drive) {
  const auto scans = messages_of(drive, Channel::kScan);
  const auto images = messages_of(drive, Channel::kImage);
  std::vector<ScanSet> sets;
  std::int64_t sent_until = INT64_MIN;
  for (std::size_t i = 0; i + 1 < scans.size(); ++i) {
    const std::int64_t utime = scans[i]->utime, next_utime = scans[i + 1]->utime;
    const auto image = std::find_if(images.begin(), images.end(), [utime](const auto* message) {
      return message->utime == utime;
    });
    if (image == images.end()) continue;
    ScanSet set;
    set.utime = utime;
    set.inputs.push_back(scans[i]);
    for (const Channel channel : {Channel::kOdometry, Channel::kPoseFix}) {
      for (const RawMessage* message : messages_of(drive, channel)) {
        if (message->utime > sent_until && message->utime <= next_utime) {
          set.inputs.push_back(message);
        }
      }
      if (channel == Channel::kOdometry) {
        set.num_detector_inputs = static_cast<std::uint32_t>(set.inputs.size()) + 1;
      }
    }
    set.inputs.push_back(*image);
    sent_until = next_utime;
    sets.push_back(std::move(set));
  }
  return sets;
}

MapProbe::MapProbe(const std::string& url, bool relayed) : lcm_(url), relayed_(relayed) {
  lcm_.subscribe(name_of(Channel::kMap), &MapProbe::on_map, this);
}

void MapProbe::send(Channel channel, const std::vector<std::uint8_t>& bytes) {
  if (channel == Channel::kImage) sent_ = Clock::now();
  lcm_.publish(name_of(channel), bytes.data(), static_cast<unsigned int>(bytes.size()));
}

double MapProbe::wait_for_map(std::int64_t utime, Clock::time_point until) {
  utime_ = 0;
  while (utime_ != utime) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now());
    if (left.count() <= 0) return -1.0;
    lcm_.handleTimeout(static_cast<int>(left.count()));
  }
  return std::chrono::duration<double, std::milli>(received_ - sent_).count();
}

double MapProbe::through(const ScanSet& set, Clock::time_point until) {
  for (const RawMessage* input : set.inputs) send(input->channel, input->bytes);
  return wait_for_map(set.utime, until);
}

void MapProbe::on_map(const lcm::ReceiveBuffer* buffer, const std::string&) {
  received_ = Clock::now();
  const auto* bytes = static_cast<const std::uint8_t*>(buffer->data);
  RelayHeader header;
  if (buffer->data_size < sizeof header) return;
  std::memcpy(&header, bytes, sizeof header);
  // An LCM type begins with its hash; then comes utime, big-endian.
  std::int64_t utime = 0;
  for (int i = 8; i < 16; ++i) utime = utime << 8 | bytes[i];
  utime_ = relayed_ ? header.utime : utime;
}

std::vector<ChildProcess> start_relays(const std::string& lcm_url, const TemporaryFolder& folder) {
  std::vector<ChildProcess> relays;
  for (const std::string role : {"detector", "pose", "mapper"}) {
    const std::string output = folder.path("relay_" + role);
    relays.emplace_back(std::vector<std::string>{this_program(), kRelayFlag, lcm_url, role},
                        output);
    for (int i = 0; !is_ready(output); ++i) {
      if (i == 1000) throw std::runtime_error("a relay does not start");
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  return relays;
}

bool is_relay(int argc, char** argv) { return argc == 4 && std::strcmp(argv[1], kRelayFlag) == 0; }

int run_relay(char** argv) {
  lcm::LCM lcm(argv[2]);
  if (!lcm.good()) return 1;
  Relay relay(lcm, argv[3]);
  std::printf("ready\n");
  std::fflush(stdout);
  while (lcm.handle() == 0) {
  }
  return 0;
}

std::int64_t count_played(const std::string& log_path, const std::string& lcm_url,
                          int queue_capacity, const TemporaryFolder& folder) {
  const std::string output = folder.path("counter");
  ChildProcess counter({this_program(), kCounterFlag, lcm_url, std::to_string(queue_capacity)},
                       output);
  for (int i = 0; number_after(output, "ready") < 0; ++i) {
    if (i == 1000) throw std::runtime_error("the counting subscriber does not start");
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ChildProcess player({"lcm-logplayer", "--speed=0", "--lcm-url=" + lcm_url, log_path},
                      folder.path("lcm-logplayer"));
  if (player.wait() != 0) throw std::runtime_error("lcm-logplayer failed");
  counter.stop();
  return number_after(output, "received");
}

bool is_counter(int argc, char** argv) {
  return argc == 4 && std::strcmp(argv[1], kCounterFlag) == 0;
}

int run_counter(char** argv) {
  struct sigaction action {};
  action.sa_handler = [](int) { stop_asked = 1; };
  sigaction(SIGINT, &action, nullptr);
  lcm::LCM lcm(argv[2]);
  if (!lcm.good()) return 1;
  Counter counter;
  lcm.subscribe(".*", &Counter::count, &counter)->setQueueCapacity(std::atoi(argv[3]));
  std::printf("ready 1\n");
  std::fflush(stdout);
  while (stop_asked == 0) lcm.handleTimeout(50);
  // What LCM's own thread still holds counts as well.
  while (lcm.handleTimeout(300) > 0) {
  }
  std::printf("received %lld\n", counter.num_received);
  return 0;
}

}  // namespace orchard::bench
