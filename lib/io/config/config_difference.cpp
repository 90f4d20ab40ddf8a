// SPDX-License-Identifier: BSD-3-Clause
#include "io/config/config_difference.hpp"

#include <yaml-cpp/yaml.h>

#include <map>
#include <utility>

#include "io/config/config_file.hpp"

namespace orchard::io {
namespace {

constexpr const char* kNone = "(none)";

/// Max number of lines listed for the user.
constexpr std::size_t kMaxLines = 20;

using Values = std::vector<std::pair<std::string, std::string>>;

std::string value_text(YAML::Node node) {
  if (node.IsNull()) return kNone;
  if (node.IsSequence()) node.SetStyle(YAML::EmitterStyle::Flow);
  return YAML::Dump(node);
}

void flatten(const YAML::Node& node, const std::string& prefix, Values& values) {
  for (const auto& entry : node) {
    const std::string key = prefix + entry.first.Scalar();
    if (entry.second.IsMap()) {
      flatten(entry.second, key + ".", values);
    } else {
      values.emplace_back(key, value_text(entry.second));
    }
  }
}

bool reaches_the_map(const std::string& key) {
  for (const char* section : {"lcm.", "drivers.", "simulation."}) {
    if (key.rfind(section, 0) == 0) return false;
  }
  return true;
}

Values values_of(const std::string& yaml) {
  YAML::Node root;
  try {
    root = YAML::Load(yaml);
  } catch (const YAML::Exception& error) {
    throw ConfigError({std::string("a configuration is not valid YAML: ") + error.msg});
  }
  Values values;
  if (root.IsMap()) flatten(root, "", values);
  return values;
}

}  // namespace

std::vector<ConfigDifference> config_differences(const std::string& a, const std::string& b) {
  const Values values_a = values_of(a);
  const Values values_b = values_of(b);
  std::map<std::string, std::string> rest_of_b(values_b.begin(), values_b.end());
  std::vector<ConfigDifference> differences;
  for (const auto& [key, value] : values_a) {
    const auto found = rest_of_b.find(key);
    const std::string other = found == rest_of_b.end() ? kNone : found->second;
    if (found != rest_of_b.end()) rest_of_b.erase(found);
    if (value != other && reaches_the_map(key)) differences.push_back({key, value, other});
  }
  for (const auto& [key, value] : values_b) {
    if (rest_of_b.count(key) && reaches_the_map(key)) differences.push_back({key, kNone, value});
  }
  return differences;
}

std::vector<std::string> difference_lines(const std::vector<ConfigDifference>& differences) {
  std::vector<std::string> lines;
  for (const ConfigDifference& difference : differences) {
    if (lines.size() == kMaxLines) {
      lines.push_back("and " + std::to_string(differences.size() - kMaxLines) + " more");
      break;
    }
    lines.push_back(difference.key + ": " + difference.a + " -> " + difference.b);
  }
  return lines;
}

}  // namespace orchard::io
