// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::io {

/// A key of an earlier version.
struct OldKey {
  const char* path;  ///< with the present names of its sections: "mapper.existence.past_rate"
  const char* name;  ///< its name now, in the same section; null: no longer a key
  const char* fixed_at = "";  ///< no longer a key: its value for good; empty: without effect
};

/// The keys of the last version that have another name now, or none. They go with the next one.
const std::vector<OldKey>& old_keys();

/// The former names of a key or section, given its present path.
std::vector<std::string> former_names(const std::string& path);

/// The entry of a key that is none any more; null when there never was such a key.
const OldKey* find_fixed_key(const std::string& path);

}  // namespace orchard::io
