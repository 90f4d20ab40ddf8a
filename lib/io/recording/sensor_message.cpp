// SPDX-License-Identifier: BSD-3-Clause
#include "io/recording/sensor_message.hpp"

#include <algorithm>
#include <array>

namespace orchard::io {

void sort_and_number(std::vector<SensorMessage>& messages) {
  std::stable_sort(messages.begin(), messages.end(),
                   [](const SensorMessage& a, const SensorMessage& b) {
                     const std::int64_t time_a = utime_of(a), time_b = utime_of(b);
                     return time_a != time_b ? time_a < time_b : a.index() < b.index();
                   });
  std::array<std::int32_t, std::variant_size_v<SensorMessage>> next_seq{};
  for (SensorMessage& message : messages) {
    const std::int32_t seq = next_seq[message.index()]++;
    std::visit([seq](auto& m) { m.seq = seq; }, message);
  }
}

}  // namespace orchard::io
