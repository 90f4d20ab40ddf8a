// SPDX-License-Identifier: BSD-3-Clause
#include "io/config/yaml_printer.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "text/number_text.hpp"

namespace orchard::io {
namespace {

/// One key, or the head of a section, to be printed.
struct Line {
  int depth = 0;
  std::string key;
  std::string value;  ///< empty for the head of a section
  std::string comment;
  bool is_section = false;
  bool is_expert = false;
};

std::string range_text(const ConfigKey& key, double lo, double hi) {
  return std::string(key.unit) + " in [" + shortest_text(lo) + ", " + shortest_text(hi) +
         "]: " + key.doc;
}

class LineCollector : public ConfigVisitor {
 public:
  std::vector<Line> lines;

 private:
  void on_number(const ConfigKey& key, double& value, double lo, double hi) override {
    add(key, shortest_text(value), range_text(key, lo, hi));
  }
  void on_integer(const ConfigKey& key, int& value, int lo, int hi) override {
    add(key, std::to_string(value), range_text(key, lo, hi));
  }
  void on_flag(const ConfigKey& key, bool& value) override {
    add(key, value ? "true" : "false", std::string("true|false: ") + key.doc);
  }
  void on_text(const ConfigKey& key, std::string& value) override {
    add(key, YAML::Dump(YAML::Node(value)), key.doc);
  }
  void on_choice(const ConfigKey& key, int& index,
                 std::initializer_list<const char*> names) override {
    std::string options;
    for (const char* name : names) options += std::string(options.empty() ? "" : "|") + name;
    add(key, *(names.begin() + index), options + ": " + key.doc);
  }
  void on_numbers(const ConfigKey& key, const NumberList& list, double lo, double hi) override {
    std::string text = "[";
    for (std::size_t i = 0; i < list.size; ++i) {
      text += (i > 0 ? ", " : "") + shortest_text(list.data[i]);
    }
    add(key, text + "]", range_text(key, lo, hi));
  }
  void on_section(const ConfigKey& key, const std::function<void()>& visit) override {
    lines.push_back({depth_, key.name, "", key.doc, true, key.is_expert});
    ++depth_;
    visit();
    --depth_;
  }
  void on_broken_check(const char*, const char*) override {}

  void add(const ConfigKey& key, const std::string& value, const std::string& comment) {
    lines.push_back({depth_, key.name, value, comment, false, key.is_expert});
  }

  int depth_ = 0;
};

std::vector<Line> lines_of(const ConfigSchema& schema) {
  LineCollector collector;
  schema(collector);
  return collector.lines;
}

/// Removes sections without keys.
std::vector<Line> without_empty_sections(const std::vector<Line>& lines) {
  std::vector<Line> kept;
  int depth_below = -1;  // depth of the key or section that follows
  for (auto line = lines.rbegin(); line != lines.rend(); ++line) {
    if (line->is_section && depth_below <= line->depth) continue;
    depth_below = line->depth;
    kept.push_back(*line);
  }
  std::reverse(kept.begin(), kept.end());
  return kept;
}

std::string text_of(const std::vector<Line>& lines, bool explain) {
  std::string text;
  for (const Line& line : lines) {
    text += std::string(2 * static_cast<std::size_t>(line.depth), ' ') + line.key + ":";
    if (!line.is_section) text += " " + line.value;
    if (explain) text += std::string("  # ") + (line.is_expert ? "expert: " : "") + line.comment;
    text += "\n";
  }
  return text;
}

}  // namespace

std::string print_all_keys(const ConfigSchema& schema) { return text_of(lines_of(schema), true); }

std::string print_user_keys(const ConfigSchema& schema, const ConfigSchema& defaults) {
  const std::vector<Line> lines = lines_of(schema);
  const std::vector<Line> default_lines = lines_of(defaults);
  std::vector<Line> kept;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Line& line = lines[i];
    if (line.is_section || !line.is_expert || line.value != default_lines[i].value) {
      kept.push_back(line);
    }
  }
  return text_of(without_empty_sections(kept), true);
}

std::string print_values(const ConfigSchema& schema) { return text_of(lines_of(schema), false); }

}  // namespace orchard::io
