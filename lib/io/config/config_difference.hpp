// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::io {

/// A key whose value differs between two configurations.
struct ConfigDifference {
  std::string key;  ///< full path: "detector.tree_threshold"
  std::string a;    ///< value in YAML; "(none)" if the key is missing
  std::string b;
};

/// Lists the keys whose values differ between two configurations, in the order of the first one.
///
/// Both are YAML as written by effective_config(). Sections `lcm`, `drivers` and `simulation` are
/// ignored because they do not affect the result of a log. Throws ConfigError when a text is not
/// YAML.
std::vector<ConfigDifference> config_differences(const std::string& a, const std::string& b);

/// Formats the differences as "key: a -> b", one line each; after twenty only their number.
std::vector<std::string> difference_lines(const std::vector<ConfigDifference>& differences);

}  // namespace orchard::io
