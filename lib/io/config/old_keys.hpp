// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::io {

/// A key of the previous version that was renamed or removed.
struct OldKey {
  const char* path;  ///< with the present names of its sections: "mapper.existence.past_rate"
  const char* name;  ///< present name, in the same section; null: removed
  const char* fixed_at = "";  ///< removed key: its constant value; empty: it has no effect
};

/// Lists the keys of the previous version that were renamed or removed; they are dropped with the
/// next version.
const std::vector<OldKey>& old_keys();

/// Former names of a key or section, given its present path.
std::vector<std::string> former_names(const std::string& path);

/// Entry of a removed key; null if there was no such key.
const OldKey* find_fixed_key(const std::string& path);

}  // namespace orchard::io
