// SPDX-License-Identifier: BSD-3-Clause
// Takes the derived messages of a log apart: DIR/<CHANNEL>.bytes holds the bytes of the messages of
// one channel, in order of seq. Two logs agree in a channel when these files do.
//   channel_bytes LOG DIR
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "bus/messages/codec.hpp"
#include "io/log/log_reader.hpp"

namespace {

using namespace orchard;
using Numbered = std::pair<std::int32_t, std::vector<std::uint8_t>>;

void take_apart(const std::string& log_path, const std::string& folder) {
  std::array<std::vector<Numbered>, bus::kNumChannels> messages;
  io::LogReader reader(log_path);
  while (auto event = reader.next()) {
    const auto channel = bus::find_channel(event->channel);
    if (!channel || bus::info(*channel).role != bus::Role::kDerived) continue;
    const auto decoded = bus::decode(*channel, event->data.data(), event->data.size());
    const auto* message = std::get_if<bus::Message>(&decoded);
    if (message == nullptr) throw std::runtime_error(log_path + " holds a message that is refused");
    messages[static_cast<std::size_t>(*channel)].emplace_back(bus::seq_of(*message),
                                                              std::move(event->data));
  }
  std::filesystem::create_directories(folder);
  for (const bus::ChannelInfo& channel : bus::kChannels) {
    auto& list = messages[static_cast<std::size_t>(channel.channel)];
    if (channel.role != bus::Role::kDerived) continue;
    std::stable_sort(list.begin(), list.end(),
                     [](const Numbered& a, const Numbered& b) { return a.first < b.first; });
    std::ofstream file(folder + "/" + std::string(channel.name) + ".bytes", std::ios::binary);
    for (const auto& [seq, bytes] : list) {
      file.write(reinterpret_cast<const char*>(bytes.data()),
                 static_cast<std::streamsize>(bytes.size()));
    }
    if (!file.flush()) throw std::runtime_error(folder + " cannot be written");
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: channel_bytes LOG DIR\n");
    return 2;
  }
  try {
    take_apart(argv[1], argv[2]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "channel_bytes: %s\n", error.what());
    return 1;
  }
}
