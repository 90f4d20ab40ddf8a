// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/rejection_log.hpp"

#include <spdlog/spdlog.h>

namespace orchard::bus {

void RejectionLog::note(Channel channel, const Rejection& rejection) {
  const auto index =
      static_cast<std::size_t>(channel) * kNumReasons + static_cast<std::size_t>(rejection.reason);
  Entry& entry = entries_[index];
  const auto now = std::chrono::steady_clock::now();
  if (entry.used && now - entry.last < std::chrono::seconds(5)) {
    ++entry.num_silent;
    return;
  }
  spdlog::warn(
      "{}: refused an invalid message ({}: {}); {} more of this kind since the last report",
      info(channel).name, to_string(rejection.reason), rejection.detail, entry.num_silent);
  entry = {now, 0, true};
}

}  // namespace orchard::bus
