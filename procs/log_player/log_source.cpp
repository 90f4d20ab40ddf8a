// SPDX-License-Identifier: BSD-3-Clause
#include "log_player/log_source.hpp"

#include <utility>
#include <variant>

#include "bus/messages/codec.hpp"

namespace orchard::procs {

LogSource::LogSource(const std::string& log_path, const bus::ReplayOptions& options)
    : index_(bus::index_log(log_path, options)), next_(index_.entries.begin()), reader_(log_path) {}

std::optional<bus::Message> LogSource::next() {
  if (next_ == index_.entries.end()) return std::nullopt;
  const bus::ReplayEntry entry = *next_;
  ++next_;
  const std::vector<std::uint8_t> bytes = reader_.read_at(entry.offset).data;
  // The index holds only messages that passed the guard.
  return std::get<bus::Message>(bus::decode(entry.channel, bytes.data(), bytes.size()));
}

}  // namespace orchard::procs
