// SPDX-License-Identifier: BSD-3-Clause
#include "io/config/config.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <set>
#include <sstream>
#include <utility>

namespace orchard::io {
namespace {

/// No list of a rig is anywhere near as long; a file that has one is no rig's.
constexpr std::size_t kMaxNumbers = 4096;

std::string join(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "" : "\n") + line;
  return text;
}

/// Shortest decimal text that reads back as the same double.
std::string number_text(double value) {
  std::array<char, 64> buffer;
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), result.ptr};
}

/// A list as YAML writes it inline.
std::string numbers_text(const double* values, std::size_t size) {
  std::string text = "[";
  for (std::size_t i = 0; i < size; ++i) text += (i > 0 ? ", " : "") + number_text(values[i]);
  return text + "]";
}

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, diagonal + (a[i - 1] != b[j - 1])});
      diagonal = above;
    }
  }
  return row[b.size()];
}

/// The visitor that fills a configuration from YAML and collects what is wrong with it.
class Loader {
 public:
  Loader(YAML::Node node, std::string file, std::string prefix, std::vector<std::string>& problems)
      : node_(std::move(node)),
        file_(std::move(file)),
        prefix_(std::move(prefix)),
        problems_(problems) {}

  void number(const char* key, double& value, double lo, double hi, const char*, const char*) {
    known_.insert(key);
    if (const YAML::Node field = find(key)) read_number(field, key, value, lo, hi);
  }

  void integer(const char* key, int& value, int lo, int hi, const char*, const char*) {
    known_.insert(key);
    const YAML::Node field = find(key);
    if (!field) return;
    int parsed = 0;
    const std::string text = scalar(field);
    const auto result = std::from_chars(text.data(), text.data() + text.size(), parsed);
    if (text.empty() || result.ec != std::errc() || result.ptr != text.data() + text.size()) {
      return problem(field, key, text, "must be a whole number");
    }
    if (parsed < lo || parsed > hi) {
      return problem(field, key, text,
                     "must be in [" + std::to_string(lo) + ", " + std::to_string(hi) + "]");
    }
    value = parsed;
  }

  void flag(const char* key, bool& value, const char*) {
    known_.insert(key);
    const YAML::Node field = find(key);
    if (!field) return;
    const std::string text = scalar(field);
    if (text != "true" && text != "false") {
      return problem(field, key, text, "must be true or false");
    }
    value = text == "true";
  }

  void text(const char* key, std::string& value, const char*) {
    known_.insert(key);
    const YAML::Node field = find(key);
    if (!field) return;
    if (!field.IsScalar()) return problem(field, key, scalar(field), "must be a text");
    const auto is_control = [](char c) { return std::iscntrl(static_cast<unsigned char>(c)) != 0; };
    if (std::string shown = field.Scalar(); std::any_of(shown.begin(), shown.end(), is_control)) {
      std::replace_if(shown.begin(), shown.end(), is_control, '?');
      return problem(field, key, shown, "must not hold control characters (here: ?)");
    }
    value = field.Scalar();
  }

  template <class Enum>
  void choice(const char* key, Enum& value, std::initializer_list<const char*> names, const char*) {
    known_.insert(key);
    const YAML::Node field = find(key);
    if (!field) return;
    const std::string text = scalar(field);
    std::string options;
    int index = 0;
    for (const char* name : names) {
      if (text == name) {
        value = static_cast<Enum>(index);
        return;
      }
      options += std::string(options.empty() ? "" : ", ") + name;
      ++index;
    }
    problem(field, key, text, "must be one of " + options);
  }

  template <std::size_t N>
  void numbers(const char* key, std::array<double, N>& values, double lo, double hi, const char*,
               const char*) {
    known_.insert(key);
    const YAML::Node field = find(key);
    if (!field) return;
    if (!field.IsSequence() || field.size() != N) {
      return problem(field, key, scalar(field),
                     "must be a list of " + std::to_string(N) + " numbers");
    }
    for (std::size_t i = 0; i < N; ++i) {
      read_number(field[i], std::string(key) + "[" + std::to_string(i) + "]", values[i], lo, hi);
    }
  }

  void numbers(const char* key, std::vector<double>& values, double lo, double hi, const char*,
               const char*) {
    known_.insert(key);
    const YAML::Node field = find(key);
    if (!field) return;
    if (!field.IsSequence() || field.size() > kMaxNumbers) {
      return problem(field, key, scalar(field),
                     "must be a list of numbers, at most " + std::to_string(kMaxNumbers));
    }
    values.assign(field.size(), 0.0);
    for (std::size_t i = 0; i < values.size(); ++i) {
      read_number(field[i], std::string(key) + "[" + std::to_string(i) + "]", values[i], lo, hi);
    }
  }

  template <class Section>
  void section(const char* key, Section& value, const char*) {
    known_.insert(key);
    YAML::Node field = find(key);
    if (field && !field.IsMap() && !field.IsNull()) {
      return problem(field, key, scalar(field), "must be a section with keys of its own");
    }
    if (!field) field = YAML::Node(YAML::NodeType::Map);
    Loader loader(field, file_, prefix_ + key + ".", problems_);
    describe(loader, value);
    loader.refuse_unknown();
  }

  void check(bool holds, const char* key, const char* why) {
    if (holds) return;
    const YAML::Node field = find(key);
    problem(field ? field : node_, key, field ? scalar(field) : "(default)", why);
  }

  void refuse_unknown() {
    if (!node_.IsMap()) return;
    std::set<std::string> seen;
    for (const auto& entry : node_) {
      const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "(not a text)";
      const std::string where = location(entry.first) + prefix_ + key;
      if (!seen.insert(key).second) problems_.push_back(where + ": stands here twice");
      if (known_.count(key)) continue;
      problems_.push_back(where + ": unknown key; did you mean " + nearest(key) + "?");
    }
  }

 private:
  YAML::Node find(const char* key) const {
    if (!node_.IsMap()) return YAML::Node(YAML::NodeType::Undefined);
    for (const auto& entry : node_) {
      if (entry.first.IsScalar() && entry.first.Scalar() == key) return entry.second;
    }
    return YAML::Node(YAML::NodeType::Undefined);
  }

  static std::string scalar(const YAML::Node& field) {
    if (field.IsScalar()) return field.Scalar();
    return field.IsNull() ? "(nothing)" : field.IsSequence() ? "(a list)" : "(a section)";
  }

  std::string location(const YAML::Node& field) const {
    return file_ + ":" + std::to_string(field.Mark().line + 1) + ": ";
  }

  void problem(const YAML::Node& field, const std::string& key, const std::string& value,
               const std::string& why) {
    problems_.push_back(location(field) + prefix_ + key + " = " + value + ": " + why);
  }

  void read_number(const YAML::Node& field, const std::string& key, double& value, double lo,
                   double hi) {
    const std::string text = scalar(field);
    double parsed = 0.0;
    const char* begin = text.data();
    if (!text.empty() && *begin == '+') ++begin;
    const auto result = std::from_chars(begin, text.data() + text.size(), parsed);
    if (text.empty() || result.ec != std::errc() || result.ptr != text.data() + text.size()) {
      return problem(field, key, text, "must be a number");
    }
    if (!(parsed >= lo && parsed <= hi)) {
      return problem(field, key, text,
                     "must be in [" + number_text(lo) + ", " + number_text(hi) + "]");
    }
    value = parsed;
  }

  std::string nearest(const std::string& key) const {
    std::string best;
    std::size_t best_distance = ~std::size_t{0};
    for (const std::string& candidate : known_) {
      const std::size_t distance = edit_distance(key, candidate);
      if (distance < best_distance) {
        best_distance = distance;
        best = candidate;
      }
    }
    return best;
  }

  YAML::Node node_;
  std::string file_;
  std::string prefix_;
  std::vector<std::string>& problems_;
  std::set<std::string> known_;
};

/// The visitor that writes a configuration as YAML, with or without explanations.
class Printer {
 public:
  explicit Printer(bool explain) : explain_(explain) {}

  void number(const char* key, double& value, double lo, double hi, const char* unit,
              const char* doc) {
    line(key, number_text(value), range_text(lo, hi, unit, doc));
  }
  void integer(const char* key, int& value, int lo, int hi, const char* unit, const char* doc) {
    line(key, std::to_string(value), range_text(lo, hi, unit, doc));
  }
  void flag(const char* key, bool& value, const char* doc) {
    line(key, value ? "true" : "false", std::string("true|false: ") + doc);
  }
  void text(const char* key, std::string& value, const char* doc) {
    line(key, YAML::Dump(YAML::Node(value)), doc);
  }
  template <class Enum>
  void choice(const char* key, Enum& value, std::initializer_list<const char*> names,
              const char* doc) {
    std::string options;
    for (const char* name : names) options += std::string(options.empty() ? "" : "|") + name;
    line(key, *(names.begin() + static_cast<int>(value)), options + ": " + doc);
  }
  template <class Numbers>  // std::array or std::vector
  void numbers(const char* key, Numbers& values, double lo, double hi, const char* unit,
               const char* doc) {
    line(key, numbers_text(values.data(), values.size()), range_text(lo, hi, unit, doc));
  }
  template <class Section>
  void section(const char* key, Section& value, const char* doc) {
    out_ << std::string(indent_, ' ') << key << ":";
    if (explain_) out_ << "  # " << doc;
    out_ << "\n";
    indent_ += 2;
    describe(*this, value);
    indent_ -= 2;
  }
  void check(bool, const char*, const char*) {}

  std::string str() const { return out_.str(); }

 private:
  static std::string range_text(double lo, double hi, const char* unit, const char* doc) {
    return std::string(unit) + " in [" + number_text(lo) + ", " + number_text(hi) + "]: " + doc;
  }
  void line(const char* key, const std::string& value, const std::string& comment) {
    out_ << std::string(indent_, ' ') << key << ": " << value;
    if (explain_) out_ << "  # " << comment;
    out_ << "\n";
  }

  bool explain_;
  int indent_ = 0;
  std::ostringstream out_;
};

}  // namespace

ConfigError::ConfigError(std::vector<std::string> problems)
    : std::runtime_error(join(problems)), problems_(std::move(problems)) {}

Config parse_config(const std::string& yaml, const std::string& name) {
  YAML::Node root;
  try {
    root = YAML::Load(yaml);
  } catch (const YAML::Exception& error) {
    throw ConfigError(
        {name + ":" + std::to_string(error.mark.line + 1) + ": not YAML: " + error.msg});
  }
  if (root.IsNull()) root = YAML::Node(YAML::NodeType::Map);
  if (!root.IsMap()) {
    throw ConfigError({name + ":1: must be sections with keys, such as \"detector:\""});
  }
  Config config;
  std::vector<std::string> problems;
  Loader loader(root, name, "", problems);
  describe(loader, config);
  loader.refuse_unknown();
  if (!problems.empty()) throw ConfigError(std::move(problems));
  return config;
}

Config load_config(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) {
    throw ConfigError({path + ": cannot be read; give an existing file with --config"});
  }
  return parse_config(text.str(), path);
}

std::string print_config(const Config& config) {
  Config copy = config;
  Printer printer(true);
  describe(printer, copy);
  return printer.str();
}

std::string effective_config(const Config& config) {
  Config copy = config;
  Printer printer(false);
  describe(printer, copy);
  return printer.str();
}

std::int64_t config_hash(const Config& config) {
  std::uint64_t hash = 1469598103934665603ull;
  for (const char c : effective_config(config)) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  }
  return static_cast<std::int64_t>(hash);
}

}  // namespace orchard::io
