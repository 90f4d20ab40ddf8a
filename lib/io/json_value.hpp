// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace orchard::io {

/// Where JSON comes from, for messages.
struct JsonSource {
  std::string place;   ///< "map/graph.json", "map/corrections.jsonl:3"
  std::string advice;  ///< "map the log again"
};

/// A value of JSON from outside: what is not as it must be is a FileError that names the source.
class JsonValue {
 public:
  using Json = nlohmann::ordered_json;

  /// Both must outlive it.
  JsonValue(const Json& json, const JsonSource& source) : json_(&json), source_(&source) {}

  [[noreturn]] void fail(const std::string& what) const;
  bool has(const char* key) const;
  JsonValue at(const char* key) const;
  std::vector<JsonValue> list(const char* key) const;
  std::string text(const char* key) const { return at(key).as_text(key); }
  std::vector<std::string> texts(const char* key) const;
  double number(const char* key, double lo, double hi) const { return at(key).in(key, lo, hi); }
  std::int32_t whole(const char* key, double lo,
                     double hi = std::numeric_limits<std::int32_t>::max()) const;

  /// This value itself as a place [m], a list of two numbers.
  Eigen::Vector2d place() const;
  /// That of two keys.
  Eigen::Vector2d place(const char* x_key, const char* y_key) const;
  std::vector<Eigen::Vector2d> places(const char* key) const;

 private:
  std::string as_text(const std::string& name) const;
  double in(const std::string& name, double lo, double hi) const;
  std::vector<JsonValue> elements() const;

  const Json* json_;
  const JsonSource* source_;
};

}  // namespace orchard::io
