// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/config/config_error.hpp"

namespace orchard::io {

/// Where the messages go. Section `lcm`.
struct LcmConfig {
  std::string url = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304";
};

template <class Visitor>
void describe(Visitor& v, LcmConfig& c) {
  v.text("url", c.url, "LCM provider; ttl=0 stays on this machine, ttl=1 reaches its network");
}

/// A configuration as CONFIG carries it: all keys with their values, and a number that stands for
/// them.
struct EffectiveConfig {
  std::string text;       ///< YAML without comments, which reads back as the same configuration
  std::int64_t hash = 0;  ///< FNV-1a of the text with the default lcm.url
};

/// Which keys are printed.
enum class PrintedKeys {
  kUser,  ///< those for users, and what differs from its default among those for experts
  kAll,
};

/// The configuration of a process, whatever its sections are: what the bus needs of it.
class ConfigFile {
 public:
  virtual ~ConfigFile() = default;

  /// Reads a rig's YAML over the defaults; gives warnings, one line each. Throws ConfigError.
  virtual std::vector<std::string> load(const std::string& path) = 0;

  virtual LcmConfig& lcm() = 0;
  virtual EffectiveConfig effective() const = 0;

  /// Values, units, ranges and meanings, as YAML that load() reads.
  virtual std::string print(PrintedKeys keys) const = 0;
};

}  // namespace orchard::io
