// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <variant>

#include "bus/messages/message.hpp"
#include "io/recording/recording_folder.hpp"

namespace orchard::cli {

using NextMessage = std::function<std::optional<bus::Message>()>;

/// Numbers of the imported messages and their range of time.
struct Imported {
  std::array<std::int64_t, bus::kNumChannels> num_messages{};
  std::int64_t first_utime = 0;
  std::int64_t last_utime = 0;
  std::int64_t num_all = 0;
};

/// Writes messages to a log until `next` returns none. `num_all`: their number, 0 when unknown.
/// Throws io::FileError.
Imported write_imported(const NextMessage& next, std::uint64_t num_all,
                        const std::string& out_path);

void print_imported(const std::string& out_path, const Imported& imported);

/// Prints the ignored inputs and their numbers.
void print_ignored(const std::map<std::string, std::int64_t>& ignored);

inline bus::Message as_message(io::SensorMessage sensed) {
  return std::visit([](auto&& m) { return bus::Message(std::move(m)); }, std::move(sensed));
}

}  // namespace orchard::cli
