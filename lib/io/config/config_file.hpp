// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace orchard::io {

/// Thrown for an invalid configuration: one line per error, "file:line: key = value: why".
class ConfigError : public std::runtime_error {
 public:
  explicit ConfigError(std::vector<std::string> problems);
  const std::vector<std::string>& problems() const { return problems_; }

 private:
  std::vector<std::string> problems_;
};

/// 64-bit FNV-1a hash of a text: the hash of a configuration in CONFIG.
constexpr std::int64_t text_hash(std::string_view text) {
  std::uint64_t hash = 1469598103934665603ull;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  return static_cast<std::int64_t>(hash);
}

/// LCM network to use. Section `lcm`.
struct LcmConfig {
  std::string url = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304";
};

template <class Visitor>
void describe(Visitor& v, LcmConfig& c) {
  v.text("url", c.url,
         "URL of the LCM network; ttl=0: this machine only, ttl=1: its local network");
}

/// The effective configuration as sent in CONFIG: all keys with their values, and a hash.
struct EffectiveConfig {
  std::string text;       ///< YAML without comments; reads back as the same configuration
  std::int64_t hash = 0;  ///< FNV-1a of the text with the default lcm.url
};

/// Selection of keys to print.
enum class PrintedKeys {
  kUser,  ///< keys for users, and expert keys that differ from their defaults
  kAll,
};

/// The configuration of a process, independent of its sections: the interface that the bus needs.
class ConfigFile {
 public:
  virtual ~ConfigFile() = default;

  /// Reads a rig's YAML over the defaults. Throws ConfigError.
  virtual void load(const std::string& path) = 0;

  virtual LcmConfig& lcm() = 0;
  virtual EffectiveConfig effective() const = 0;

  /// Prints values, units, ranges and meanings, as YAML that load() reads.
  virtual std::string print(PrintedKeys keys) const = 0;
};

}  // namespace orchard::io
