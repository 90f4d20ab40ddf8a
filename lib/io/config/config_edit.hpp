// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/config/config.hpp"
#include "text/number_text.hpp"

namespace orchard::io {

/// One value to set in a rig's YAML.
struct ConfigValue {
  std::string key;    ///< full path: "detector.width.mean_m"
  std::string value;  ///< as written to the file: "0.0897"
};

/// Numbers as a value: "[0.1000, 0.2000]".
template <class Numbers>
std::string config_numbers(const Numbers& numbers, int num_decimals) {
  std::string text = "[";
  for (const double number : numbers) {
    text += (text.size() > 1 ? ", " : "") + fixed_text(number, num_decimals);
  }
  return text + "]";
}

/// Sets values in a rig's YAML and keeps everything else - comments, order, spacing; missing keys
/// or sections are inserted. With a `note`, a comment line "# <tag>: <note>" is placed above the
/// first value and replaces an earlier one of the same tag.
///
/// The result is checked as by load_config(): throws ConfigError (with `name` for the file) when
/// the text is invalid before or after the change.
std::string edit_config(const std::string& yaml, const std::string& name,
                        const std::vector<ConfigValue>& values, const std::string& tag = {},
                        const std::string& note = {});

/// Applies edit_config() to a file (none: to an empty one, if `path` is empty) and writes
/// `out_path`, which may be the same file. The previous content of `out_path` is kept as
/// "<out_path>.bak". Throws ConfigError or FileError and then leaves every file unchanged.
void edit_config_file(const std::string& path, const std::string& out_path,
                      const std::vector<ConfigValue>& values, const std::string& tag,
                      const std::string& note);

/// The configuration that edit_config_file() would write; writes nothing. Throws as it does.
Config edited_config(const std::string& path, const std::vector<ConfigValue>& values);

}  // namespace orchard::io
