// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/relay.hpp"

#include <signal.h>

#include <chrono>
#include <cstring>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <stdexcept>
#include <thread>

namespace orchard::bench {
namespace {

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

}  // namespace

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

}  // namespace orchard::bench
