// SPDX-License-Identifier: BSD-3-Clause
#include "io/config/old_keys.hpp"

#include <string_view>

namespace orchard::io {

const std::vector<OldKey>& old_keys() {
  static const std::vector<OldKey> keys{
      {"mapper.save_period_s", nullptr, "1"},
  };
  return keys;
}

std::vector<std::string> former_names(const std::string& path) {
  const std::size_t begin = path.rfind('.') + 1;  // 0 without a dot
  std::vector<std::string> names;
  for (const OldKey& old : old_keys()) {
    const std::string_view old_path(old.path);
    if (old.name == nullptr || path.compare(begin, std::string::npos, old.name) != 0) continue;
    if (old_path.substr(0, begin) != std::string_view(path).substr(0, begin)) continue;
    if (old_path.find('.', begin) != std::string_view::npos) continue;
    names.emplace_back(old_path.substr(begin));
  }
  return names;
}

const OldKey* find_fixed_key(const std::string& path) {
  for (const OldKey& old : old_keys()) {
    if (old.name == nullptr && path == old.path) return &old;
  }
  return nullptr;
}

}  // namespace orchard::io
