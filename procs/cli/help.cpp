// SPDX-License-Identifier: BSD-3-Clause
#include "cli/help.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>
#include <vector>

namespace orchard::cli {
namespace {

constexpr const char* kConfigFolder = "config";

std::string replace_all(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

/// Formats "{b->1,a->0} OR {1,0}" and "{a,b}" with a vertical bar between the choices.
std::string choices_text(const std::string& list) {
  const std::size_t begin = list.find('{') + 1;
  std::string text = list.substr(begin, list.find('}') - begin);
  while (text.find("->") != std::string::npos) {
    const std::size_t arrow = text.find("->");
    text.erase(arrow, text.find(',', arrow) - arrow);
  }
  return replace_all(text, ",", "|");
}

/// Describes the value of an option, from CLI11's "TYPE:CHECK".
std::string value_text(const std::string& type_name) {
  const std::size_t colon = type_name.find(':');
  const std::string check = colon == std::string::npos ? "" : type_name.substr(colon + 1);
  std::string type = type_name.substr(0, colon);
  if (type == "UINT" || type == "INT") type = "N";
  if (type == "FLOAT") type = "X";
  if (check.find('{') != std::string::npos) return choices_text(check);
  if (const std::size_t range = check.find(" in ["); range != std::string::npos) {
    return type + replace_all(check.substr(range), " - ", " to ");
  }
  if (check == "NONNEGATIVE") return type + " from 0";
  if (check == "POSITIVE") return type + " above 0";
  return type;
}

std::string names_text(const std::set<CLI::Option*>& options) {
  std::vector<std::string> names;  // sorted by name, independent of memory addresses
  for (const CLI::Option* option : options) names.push_back(option->get_name());
  std::sort(names.begin(), names.end());
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override {
    std::string text;
    if (option->get_type_size() != 0) {
      const std::string value = value_text(option->get_type_name());
      if (!value.empty()) text += " " + value;
      const bool says_so = value.size() > 3 && value.substr(value.size() - 3) == "...";
      if (option->get_expected_max() > 1 && !says_so) text += "...";
      if (!option->get_default_str().empty()) text += " [" + option->get_default_str() + "]";
      if (option->get_required()) text += " (required)";
    }
    if (!option->get_needs().empty()) text += " (with " + names_text(option->get_needs()) + ")";
    if (!option->get_excludes().empty()) {
      text += " (not with " + names_text(option->get_excludes()) + ")";
    }
    return text;
  }
};

}  // namespace

void set_up_help(CLI::App& app) {
  const auto formatter = std::make_shared<HelpFormatter>();
  formatter->column_width(34);
  formatter->label("SUBCOMMAND", "COMMAND");
  app.formatter(formatter);
}

void finish_help(CLI::App& app) {
  app.set_version_flag("-V,--version", "orchard " ORCHARD_VERSION, "print the version and exit");
  if (CLI::Option* help = app.get_help_ptr()) help->description("print this help and exit");
  const std::string folder = config_folder();
  app.footer(replace_all(app.get_footer(), std::string(kConfigFolder) + "/", folder + "/"));
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    command->group("Commands");
    finish_help(*command);
  }
}

std::string config_folder() {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path installed = program.parent_path() / ".." / "share" / "orchard-mapper" / "config";
  if (!error && fs::is_directory(installed, error)) return installed.lexically_normal().string();
  return kConfigFolder;
}

}  // namespace orchard::cli
