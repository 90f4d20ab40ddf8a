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
#include "io/recording/sensor_message.hpp"

namespace orchard::cli {

using NextMessage = std::function<std::optional<bus::Message>()>;

/// What a log was written of.
struct Imported {
  std::array<std::int64_t, bus::kNumChannels> num_messages{};
  std::int64_t first_utime = 0;
  std::int64_t last_utime = 0;
  std::int64_t num_all = 0;
};

/// Writes messages as a log until `next` gives none. `num_all`: how many there are, 0 when that is
/// not known. Throws io::FileError.
Imported write_imported(const NextMessage& next, std::uint64_t num_all,
                        const std::string& out_path);

void print_imported(const std::string& out_path, const Imported& imported);

/// Prints what was not used, and how often.
void print_ignored(const std::map<std::string, std::int64_t>& ignored);

inline bus::Message as_message(io::SensorMessage sensed) {
  return std::visit([](auto&& m) { return bus::Message(std::move(m)); }, std::move(sensed));
}

}  // namespace orchard::cli
