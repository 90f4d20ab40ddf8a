// SPDX-License-Identifier: BSD-3-Clause
#include "ros/cdr_message.hpp"

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace orchard::ros {

extern const char* const kRos2Types;  // ros2_types.msg, embedded by CMake

namespace {

using Json = nlohmann::json;

/// The types of ros2_types.msg with their fields (ROS 2 Humble and later): one text for the layout
/// of the bytes and for the schema in the file.
const std::map<std::string, std::string>& definitions() {
  static const std::map<std::string, std::string> kDefinitions = [] {
    std::map<std::string, std::string> all;
    std::istringstream lines(kRos2Types);
    std::string name;
    for (std::string line; std::getline(lines, line);) {
      if (line.rfind("MSG: ", 0) == 0) {
        name = line.substr(5);
      } else {
        all[name] += line + "\n";
      }
    }
    return all;
  }();
  return kDefinitions;
}

/// The name without the part that only ROS 2 has: "sensor_msgs/LaserScan".
std::string plain_name(std::string type) {
  const std::size_t middle = type.find("/msg/");
  return middle == std::string::npos ? type : type.erase(middle, 4);
}

struct Field {
  std::string type;
  std::string name;
  bool is_sequence = false;
  std::size_t num = 1;  ///< elements of an array of fixed length
};

std::vector<Field> parse(const std::string& definition) {
  std::vector<Field> fields;
  std::istringstream words(definition);
  for (Field field; words >> field.type >> field.name; fields.push_back(field)) {
    const std::size_t bracket = field.type.find('[');
    field.is_sequence = field.type.find("[]") != std::string::npos;
    field.num = 1;
    if (bracket != std::string::npos && !field.is_sequence) {
      field.num = std::stoul(field.type.substr(bracket + 1));
    }
    field.type.erase(std::min(bracket, field.type.size()));
  }
  return fields;
}

const std::vector<Field>& fields_of(const std::string& type) {
  static const std::map<std::string, std::vector<Field>> kFields = [] {
    std::map<std::string, std::vector<Field>> all;
    for (const auto& [name, definition] : definitions()) all[name] = parse(definition);
    return all;
  }();
  return kFields.at(type);
}

class CdrWriter {
 public:
  void message(const std::string& type, const Json& values) {
    std::size_t num_known = 0;
    for (const Field& field : fields_of(type)) {
      const auto found = values.find(field.name);
      num_known += found != values.end() ? 1 : 0;
      this->field(field, found != values.end() ? *found : Json());
    }
    if (num_known < values.size()) throw std::invalid_argument(type + " lacks a field of these");
  }
  /// The header says: plain CDR, little-endian.
  std::string bytes() const { return std::string("\0\1\0\0", 4) + content_; }

 private:
  template <class T>
  void number(T value) {
    content_.resize((content_.size() + sizeof(T) - 1) / sizeof(T) * sizeof(T));
    content_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }

  void field(const Field& field, const Json& value) {
    if (value.is_binary()) {
      number(static_cast<std::uint32_t>(value.get_binary().size()));
      content_.append(value.get_binary().begin(), value.get_binary().end());
      return;
    }
    const std::size_t num = field.is_sequence ? value.size() : field.num;
    if (field.is_sequence) number(static_cast<std::uint32_t>(num));
    for (std::size_t i = 0; i < num; ++i) {
      element(field.type, value.is_array() ? value.at(i) : value);
    }
  }

  void element(const std::string& type, const Json& value) {
    const bool is_text = type == "string", is_nested = definitions().count(type) > 0;
    const double real = is_text || is_nested || value.is_null() ? 0.0 : value.get<double>();
    const auto whole = static_cast<std::int64_t>(real);
    if (type == "float64") return number(real);
    if (type == "float32") return number(static_cast<float>(real));
    if (type == "uint32" || type == "int32") return number(static_cast<std::uint32_t>(whole));
    if (type == "uint16") return number(static_cast<std::uint16_t>(whole));
    if (!is_text && !is_nested) return number(static_cast<std::uint8_t>(whole));  // bool too
    if (is_nested) return message(type, value.is_null() ? Json::object() : value);
    const std::string text = value.is_null() ? "" : value.get<std::string>();
    number(static_cast<std::uint32_t>(text.size() + 1));
    content_.append(text.c_str(), text.size() + 1);
  }

  std::string content_;
};

void add_types_within(const std::string& type, std::set<std::string>& types) {
  for (const Field& field : fields_of(type)) {
    if (definitions().count(field.type) > 0 && types.insert(field.type).second) {
      add_types_within(field.type, types);
    }
  }
}

}  // namespace

std::string definition_of(const std::string& type) {
  std::set<std::string> within;
  add_types_within(plain_name(type), within);
  std::string text = definitions().at(plain_name(type));
  for (const std::string& name : within) {
    text += std::string(80, '=') + "\nMSG: " + name + "\n" + definitions().at(name);
  }
  return text;
}

std::string cdr_message(const std::string& type, const Json& fields) {
  CdrWriter writer;
  writer.message(plain_name(type), fields);
  return writer.bytes();
}

}  // namespace orchard::ros
