// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::io {

/// A key whose value differs between two configurations.
struct ConfigDifference {
  std::string key;  ///< with its sections: "detector.tree_threshold"
  std::string a;    ///< value as YAML writes it; "(none)" where the key is missing
  std::string b;
};

/// The keys whose values differ between two configurations, in the order of the first one.
///
/// Both are YAML as effective_config() writes it. Left out are sections `lcm`, `drivers` and
/// `simulation`: what a log becomes does not depend on them. Throws ConfigError when a text is not
/// YAML.
std::vector<ConfigDifference> config_differences(const std::string& a, const std::string& b);

/// "key: a -> b" for people, one line each; of many differences the first twenty and how many more.
std::vector<std::string> difference_lines(const std::vector<ConfigDifference>& differences);

}  // namespace orchard::io
