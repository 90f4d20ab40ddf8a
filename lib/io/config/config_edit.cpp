// SPDX-License-Identifier: BSD-3-Clause
#include "io/config/config_edit.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <sstream>
#include <system_error>

#include "io/atomic_file.hpp"
#include "io/config/config.hpp"
#include "io/file_error.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

std::string join(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

std::size_t indent_of(const std::string& line) {
  const std::size_t first = line.find_first_not_of(' ');
  return first == std::string::npos ? 0 : first;
}

/// End of the plain or quoted scalar or bracketed list that begins at `begin`, within its line.
std::size_t end_of_value(const std::string& line, std::size_t begin, bool in_flow) {
  if (begin >= line.size()) return begin;
  const char first = line[begin];
  if (first == '"' || first == '\'') {
    for (std::size_t i = begin + 1; i < line.size(); ++i) {
      if (first == '"' && line[i] == '\\')
        ++i;
      else if (line[i] == first)
        return i + 1;
    }
    return line.size();
  }
  if (first == '[') {
    const std::size_t close = line.find(']', begin);
    return close == std::string::npos ? line.size() : close + 1;
  }
  std::size_t end = line.size();
  if (const std::size_t comment = line.find(" #", begin); comment != std::string::npos) {
    end = comment;
  }
  if (in_flow) {
    if (const std::size_t stop = line.find_first_of(",}", begin); stop < end) end = stop;
  }
  while (end > begin && (line[end - 1] == ' ' || line[end - 1] == '\r')) --end;
  return end;
}

/// Edits the text of a rig's YAML line by line, at the positions given by yaml-cpp.
class Editor {
 public:
  explicit Editor(const std::string& yaml) : lines_(split(yaml, '\n')) {}

  /// Sets one value and returns the (0-based) line on which it is.
  std::size_t set(const ConfigValue& value) {
    const std::vector<std::string> path = split(value.key, '.');
    YAML::Node section = YAML::Load(join(lines_));
    std::size_t depth = 0;
    YAML::Node key_node;  // of the innermost existing section
    bool in_flow = false;
    while (depth < path.size()) {
      YAML::Node found_key, found;
      if (section.IsMap()) {
        in_flow = in_flow || section.Style() == YAML::EmitterStyle::Flow;
        for (const auto& entry : section) {
          if (!entry.first.IsScalar() || entry.first.Scalar() != path[depth]) continue;
          found_key.reset(entry.first);
          found.reset(entry.second);
        }
      }
      if (!found_key.IsDefined() || found_key.IsNull()) break;
      key_node.reset(found_key);
      section.reset(found);
      ++depth;
    }
    if (depth == path.size()) return replace(key_node, section, value.value, in_flow);
    return insert(key_node, section, depth, path, value.value, in_flow);
  }

  /// Inserts the comment above a line, replacing one of the same tag.
  void note(std::size_t line, const std::string& tag, const std::string& text) {
    const std::string comment =
        std::string(indent_of(lines_[line]), ' ') + "# " + tag + ": " + text;
    if (line > 0) {
      const std::string& above = lines_[line - 1];
      if (above.compare(indent_of(above), tag.size() + 3, "# " + tag + ":") == 0) {
        lines_[line - 1] = comment;
        return;
      }
    }
    lines_.insert(lines_.begin() + static_cast<std::ptrdiff_t>(line), comment);
  }

  std::string text() const { return join(lines_); }

 private:
  std::size_t replace(const YAML::Node& key, const YAML::Node& value, const std::string& text,
                      bool in_flow) {
    if (value.IsNull()) {  // "key:" without a value
      const auto line = static_cast<std::size_t>(key.Mark().line);
      const std::size_t colon = lines_[line].find(':', static_cast<std::size_t>(key.Mark().column));
      lines_[line].insert(colon + 1, " " + text);
      return line;
    }
    const auto line = static_cast<std::size_t>(value.Mark().line);
    const auto begin = static_cast<std::size_t>(value.Mark().column);
    if (lines_[line].compare(begin, 1, "[") == 0) join_list(line, begin);
    const std::size_t end = end_of_value(lines_[line], begin, in_flow);
    lines_[line].replace(begin, end - begin, text);
    return line;
  }

  /// Joins a bracketed list of several lines into its first line, without the comments between its
  /// numbers.
  void join_list(std::size_t line, std::size_t begin) {
    while (lines_[line].find(']', begin) == std::string::npos && line + 1 < lines_.size()) {
      std::string& first = lines_[line];
      first.resize(std::min(first.size(), first.find(" #", begin)));
      first += " " + lines_[line + 1].substr(indent_of(lines_[line + 1]));
      lines_.erase(lines_.begin() + static_cast<std::ptrdiff_t>(line) + 1);
    }
  }

  std::size_t insert(const YAML::Node& key, const YAML::Node& section, std::size_t depth,
                     const std::vector<std::string>& path, const std::string& text, bool in_flow) {
    if (in_flow) {
      std::string entry = path.back() + ": " + text;
      for (std::size_t i = path.size() - 1; i-- > depth;) entry = path[i] + ": {" + entry + "}";
      const auto line = static_cast<std::size_t>(section.Mark().line);
      const auto brace = static_cast<std::size_t>(section.Mark().column);
      lines_[line].insert(brace + 1, entry + (section.size() > 0 ? ", " : ""));
      return line;
    }
    std::size_t at = lines_.size(), indent = 0;
    if (depth > 0) {
      at = static_cast<std::size_t>(key.Mark().line) + 1;
      indent = static_cast<std::size_t>(key.Mark().column) + 2;
      if (section.IsMap() && section.size() > 0) {
        const YAML::Node first = section.begin()->first;
        indent = static_cast<std::size_t>(first.Mark().column);
      }
    }
    std::vector<std::string> added;
    for (std::size_t i = depth; i < path.size(); ++i) {
      const bool last = i + 1 == path.size();
      added.push_back(std::string(indent + 2 * (i - depth), ' ') + path[i] + ":" +
                      (last ? " " + text : ""));
    }
    lines_.insert(lines_.begin() + static_cast<std::ptrdiff_t>(at), added.begin(), added.end());
    return at + added.size() - 1;
  }

  std::vector<std::string> lines_;
};

std::string text_of(const std::string& path) {
  constexpr std::size_t kBytesMax = std::size_t{1} << 20;  // derived: as load_config()
  return read_file(path, kBytesMax, "give an existing configuration");
}

}  // namespace

std::string edit_config(const std::string& yaml, const std::string& name,
                        const std::vector<ConfigValue>& values, const std::string& tag,
                        const std::string& note) {
  parse_config(yaml, name);  // rejects an invalid configuration before it is changed
  Editor editor(yaml);
  // New keys are inserted at the top of their section: inserting in reverse keeps the given order.
  for (auto value = values.rbegin(); value != values.rend(); ++value) editor.set(*value);
  if (!note.empty() && !values.empty()) {
    editor.note(editor.set(values.front()), tag, note);
  }
  const std::string edited = editor.text();
  parse_config(edited, name);
  return edited;
}

Config edited_config(const std::string& path, const std::vector<ConfigValue>& values) {
  return parse_config(edit_config(text_of(path), path, values), path);
}

void edit_config_file(const std::string& path, const std::string& out_path,
                      const std::vector<ConfigValue>& values, const std::string& tag,
                      const std::string& note) {
  const std::string edited = path.empty() ? edit_config("", out_path, values, tag, note)
                                          : edit_config(text_of(path), path, values, tag, note);
  // The file at out_path may be the only copy of another rig.
  std::error_code error;
  if (std::filesystem::is_regular_file(out_path, error)) {
    constexpr std::size_t kBytesMax = std::size_t{64} << 20;  // derived: any file of text
    const std::string old = read_file(out_path, kBytesMax, "give another file to write");
    write_file_atomically(out_path + ".bak", old);
  }
  write_file_atomically(out_path, edited);
}

}  // namespace orchard::io
