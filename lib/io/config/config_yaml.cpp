// SPDX-License-Identifier: BSD-3-Clause
#include "io/config/config_yaml.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "io/config/config_file.hpp"
#include "text/nearest_word.hpp"
#include "text/number_text.hpp"
#include "text/parse_number.hpp"

namespace orchard::io {
namespace {

/// Max length of a list; far above that of any list in a rig.
constexpr std::size_t kMaxNumbers = 4096;

std::string scalar_text(const YAML::Node& node) {
  if (node.IsScalar()) return node.Scalar();
  return node.IsNull() ? "(nothing)" : node.IsSequence() ? "(a list)" : "(a section)";
}

/// Parses the whole text as a number; a leading + is allowed. None if it is not a number.
std::optional<double> signed_number(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  return parse_number<double>(text);
}

/// Fills a configuration from YAML and collects the errors.
class Reader : public ConfigVisitor {
 public:
  Reader(const YAML::Node& root, std::string file, UnknownKeys unknown)
      : file_(std::move(file)), unknown_(unknown), root_{root, ""} {}

  /// Reports the keys of the current section that the schema did not ask for.
  void refuse_unknown() {
    if (!section_->node.IsMap()) return;
    std::set<std::string> seen;
    std::string ignored;
    int num_ignored = 0;
    for (const auto& entry : section_->node) {
      const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "(not a text)";
      const std::string where = location(entry.first) + section_->prefix + key;
      if (!seen.insert(key).second) problems.push_back(where + ": is given twice; remove one");
      if (section_->known.count(key)) continue;
      if (unknown_ == UnknownKeys::kNote) {
        ignored += (num_ignored++ > 0 ? ", " : "") + key + " = " + scalar_text(entry.second);
      } else {
        problems.push_back(where + ": unknown key; did you mean " +
                           nearest_word(key, {section_->known.begin(), section_->known.end()}) +
                           "?");
      }
    }
    if (num_ignored == 0) return;
    notes.push_back(section_->prefix + ignored +
                    (num_ignored == 1 ? " is no key of this version and is ignored"
                                      : " are no keys of this version and are ignored"));
  }

  std::vector<std::string> problems;
  std::vector<std::string> notes;

 private:
  /// The section being read.
  struct Section {
    YAML::Node node;
    std::string prefix;             ///< "detector.width."
    std::set<std::string> known{};  ///< keys that the schema has asked for
  };

  void on_number(const ConfigKey& key, double& value, double lo, double hi) override {
    if (const YAML::Node field = find(key)) read_number(field, key.name, value, lo, hi);
  }

  void on_integer(const ConfigKey& key, int& value, int lo, int hi) override {
    const YAML::Node field = find(key);
    if (!field) return;
    const std::string text = scalar_text(field);
    const auto parsed = parse_number<int>(text);
    if (!parsed) return refuse(field, key.name, text, "must be a whole number");
    if (*parsed < lo || *parsed > hi) {
      return refuse(field, key.name, text,
                    "must be in [" + std::to_string(lo) + ", " + std::to_string(hi) + "]");
    }
    value = *parsed;
  }

  void on_flag(const ConfigKey& key, bool& value) override {
    const YAML::Node field = find(key);
    if (!field) return;
    const std::string text = scalar_text(field);
    if (text != "true" && text != "false") {
      return refuse(field, key.name, text, "must be true or false");
    }
    value = text == "true";
  }

  void on_text(const ConfigKey& key, std::string& value) override {
    const YAML::Node field = find(key);
    if (!field) return;
    if (!field.IsScalar()) return refuse(field, key.name, scalar_text(field), "must be a text");
    const auto is_control = [](char c) { return std::iscntrl(static_cast<unsigned char>(c)) != 0; };
    if (std::string shown = field.Scalar(); std::any_of(shown.begin(), shown.end(), is_control)) {
      std::replace_if(shown.begin(), shown.end(), is_control, '?');
      return refuse(field, key.name, shown, "must not contain control characters (shown as ?)");
    }
    value = field.Scalar();
  }

  void on_choice(const ConfigKey& key, int& index,
                 std::initializer_list<const char*> names) override {
    const YAML::Node field = find(key);
    if (!field) return;
    const std::string text = scalar_text(field);
    std::string options;
    int i = 0;
    for (const char* name : names) {
      if (text == name) {
        index = i;
        return;
      }
      options += std::string(options.empty() ? "" : ", ") + name;
      ++i;
    }
    refuse(field, key.name, text, "must be one of " + options);
  }

  void on_numbers(const ConfigKey& key, const NumberList& list, double lo, double hi) override {
    const YAML::Node field = find(key);
    if (!field) return;
    const bool is_fixed = list.values == nullptr;
    const std::size_t max_size = is_fixed ? list.size : kMaxNumbers;
    if (!field.IsSequence() || field.size() > max_size || (is_fixed && field.size() != list.size)) {
      const std::string why =
          is_fixed ? "must be a list of " + std::to_string(list.size) + " numbers"
                   : "must be a list of numbers, at most " + std::to_string(kMaxNumbers);
      return refuse(field, key.name, scalar_text(field), why);
    }
    if (!is_fixed) list.values->assign(field.size(), 0.0);
    double* const data = is_fixed ? list.data : list.values->data();
    for (std::size_t i = 0; i < field.size(); ++i) {
      read_number(field[i], std::string(key.name) + "[" + std::to_string(i) + "]", data[i], lo, hi);
    }
  }

  void on_section(const ConfigKey& key, const std::function<void()>& visit) override {
    const YAML::Node field = find(key);
    if (field && !field.IsMap() && !field.IsNull()) {
      return refuse(field, key.name, scalar_text(field), "must be a section with keys of its own");
    }
    Section inner{field ? field : YAML::Node(YAML::NodeType::Map),
                  section_->prefix + key.name + "."};
    Section* const outer = std::exchange(section_, &inner);
    visit();
    refuse_unknown();
    section_ = outer;
  }

  void on_broken_check(const char* key, const char* why) override {
    const YAML::Node field = entry(key);
    refuse(field ? field : section_->node, key, field ? scalar_text(field) : "(default)", why);
  }

  /// The value of a key, which may have its former name; undefined if it is not given.
  YAML::Node find(const ConfigKey& key) {
    section_->known.insert(key.name);
    const YAML::Node found = entry(key.name);
    if (found || *key.former == '\0') return found;
    const YAML::Node former = entry(key.former);
    if (former) section_->known.insert(key.former);
    return former;
  }

  YAML::Node entry(const std::string& key) const {
    if (section_->node.IsMap()) {
      for (const auto& item : section_->node) {
        if (item.first.IsScalar() && item.first.Scalar() == key) return item.second;
      }
    }
    return YAML::Node(YAML::NodeType::Undefined);
  }

  std::string location(const YAML::Node& field) const {
    return file_ + ":" + std::to_string(field.Mark().line + 1) + ": ";
  }

  void refuse(const YAML::Node& field, const std::string& key, const std::string& value,
              const std::string& why) {
    problems.push_back(location(field) + section_->prefix + key + " = " + value + ": " + why);
  }

  void read_number(const YAML::Node& field, const std::string& key, double& value, double lo,
                   double hi) {
    const std::string text = scalar_text(field);
    const auto parsed = signed_number(text);
    if (!parsed) return refuse(field, key, text, "must be a number");
    if (!(*parsed >= lo && *parsed <= hi)) {
      return refuse(field, key, text,
                    "must be in [" + shortest_text(lo) + ", " + shortest_text(hi) + "]");
    }
    value = *parsed;
  }

  std::string file_;
  UnknownKeys unknown_;
  Section root_;
  Section* section_ = &root_;
};

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

std::vector<std::string> read_yaml(const std::string& yaml, const std::string& name,
                                   const ConfigSchema& schema, UnknownKeys unknown) {
  YAML::Node root;
  try {
    root = YAML::Load(yaml);
  } catch (const YAML::Exception& error) {
    throw ConfigError(
        {name + ":" + std::to_string(error.mark.line + 1) + ": is not valid YAML: " + error.msg});
  }
  if (root.IsNull()) root = YAML::Node(YAML::NodeType::Map);
  if (!root.IsMap()) {
    throw ConfigError({name + ":1: must consist of sections with keys, such as \"detector:\""});
  }
  Reader reader(root, name, unknown);
  schema(reader);
  reader.refuse_unknown();
  if (!reader.problems.empty()) throw ConfigError(std::move(reader.problems));
  return std::move(reader.notes);
}

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
