// SPDX-License-Identifier: BSD-3-Clause
#include "io/json_value.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "io/file_error.hpp"
#include "io/sane_limits.hpp"
#include "text/number_text.hpp"

namespace orchard::io {

void JsonValue::fail(const std::string& what) const {
  throw FileError(source_->place + ": " + what + "; " + source_->advice);
}

bool JsonValue::has(const char* key) const { return json_->is_object() && json_->contains(key); }

JsonValue JsonValue::at(const char* key) const {
  if (!has(key)) fail(std::string(key) + " is missing");
  return {(*json_)[key], *source_};
}

std::vector<JsonValue> JsonValue::list(const char* key) const {
  const JsonValue found = at(key);
  if (!found.json_->is_array()) fail(std::string(key) + " must be a list");
  return found.elements();
}

std::vector<std::string> JsonValue::texts(const char* key) const {
  std::vector<std::string> texts;
  for (const JsonValue& value : list(key)) texts.push_back(value.as_text(key));
  return texts;
}

std::int32_t JsonValue::whole(const char* key, double lo, double hi) const {
  const double value = number(key, lo, hi);
  if (value != std::floor(value)) fail(std::string(key) + " must be a whole number");
  return static_cast<std::int32_t>(value);
}

Eigen::Vector2d JsonValue::place() const {
  if (!json_->is_array() || json_->size() != 2) fail("a place must be two numbers");
  const std::vector<JsonValue> xy = elements();
  return {xy[0].in("a place", -kMaxCoordinate_m, kMaxCoordinate_m),
          xy[1].in("a place", -kMaxCoordinate_m, kMaxCoordinate_m)};
}

Eigen::Vector2d JsonValue::place(const char* x_key, const char* y_key) const {
  return {number(x_key, -kMaxCoordinate_m, kMaxCoordinate_m),
          number(y_key, -kMaxCoordinate_m, kMaxCoordinate_m)};
}

std::vector<Eigen::Vector2d> JsonValue::places(const char* key) const {
  std::vector<Eigen::Vector2d> places;
  for (const JsonValue& value : list(key)) places.push_back(value.place());
  return places;
}

std::string JsonValue::as_text(const std::string& name) const {
  if (!json_->is_string()) fail(name + " must be a text");
  return json_->get<std::string>();
}

double JsonValue::in(const std::string& name, double lo, double hi) const {
  const double value = json_->is_number() ? json_->get<double>() : NAN;
  if (!(value >= lo && value <= hi)) {
    fail(name + " must be a number in [" + shortest_text(lo) + ", " + shortest_text(hi) + "]");
  }
  return value;
}

std::vector<JsonValue> JsonValue::elements() const {
  std::vector<JsonValue> values;
  for (const Json& json : *json_) values.emplace_back(json, *source_);
  return values;
}

}  // namespace orchard::io
