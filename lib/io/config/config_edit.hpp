// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::io {

/// One value to set in a rig's YAML.
struct ConfigValue {
  std::string key;    ///< whole path: "detector.width.mean_m"
  std::string value;  ///< as it is to stand in the file: "0.0897"
};

/// A rig's YAML with values set: each in its place, everything else - comments, order, spacing -
/// as it was; a key or section that is missing is inserted. With a `note`, a comment line
/// "# <tag>: <note>" stands above the first value, instead of an earlier one of the same tag.
///
/// The result is checked as load_config() would: throws ConfigError (with `name` for the file)
/// when the text was no good before, or is none with the new values.
std::string edit_config(const std::string& yaml, const std::string& name,
                        const std::vector<ConfigValue>& values, const std::string& tag = {},
                        const std::string& note = {});

/// edit_config() on a file, into `out_path` (which may be the same file). What stood there is kept
/// as "<out_path>.bak". Throws ConfigError or FileError and then leaves every file as it was.
void edit_config_file(const std::string& path, const std::string& out_path,
                      const std::vector<ConfigValue>& values, const std::string& tag,
                      const std::string& note);

}  // namespace orchard::io
