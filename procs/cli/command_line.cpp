// SPDX-License-Identifier: BSD-3-Clause
#include "cli/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "bus/process/process.hpp"
#include "cli/add_command.hpp"
#include "io/config/config.hpp"
#include "io/file_error.hpp"
#include "text/nearest_word.hpp"

namespace orchard::cli {

extern const char* const kHelp;  ///< help.txt

namespace {

constexpr const char* kConfigFolder = "config";

/// The folder of the rigs that come with the program: the installed one, else config/ of the
/// checkout.
std::string config_folder() {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path installed = program.parent_path() / ".." / "share" / "orchard-mapper" / "config";
  if (!error && fs::is_directory(installed, error)) return installed.lexically_normal().string();
  return kConfigFolder;
}

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

/// Sets up the texts of the help. Call it before the commands are added; they inherit the settings.
void set_up_help(CLI::App& app) {
  const auto formatter = std::make_shared<HelpFormatter>();
  formatter->column_width(34);
  formatter->label("SUBCOMMAND", "COMMAND");
  app.formatter(formatter);
}

/// What help.txt says in a section.
struct HelpText {
  std::string description;
  std::map<std::string, std::string> options;  ///< by name
  std::string examples;
};

HelpText help_of(const std::string& section) {
  HelpText help;
  const std::string all = kHelp, head = "[" + section + "]\n";
  const std::size_t at = all.find(head);
  if (at == std::string::npos) return help;
  std::istringstream lines(all.substr(at + head.size(), all.find("\n[", at) - at - head.size()));
  std::getline(lines, help.description);
  for (std::string line; std::getline(lines, line) && !line.empty();) {
    const std::size_t colon = line.find(": ");
    help.options[line.substr(0, colon)] = line.substr(colon + 2);
  }
  help.examples.assign(std::istreambuf_iterator<char>(lines), {});
  return help;
}

/// Gives an option the description in help.txt: of the command, else of all that have such an
/// option.
void describe(CLI::Option& option, const HelpText& own, const HelpText& common,
              const std::string& title) {
  if (!option.get_description().empty()) return;
  const std::string name = option.get_name();
  for (const HelpText* help : {&own, &common}) {
    const auto found = help->options.find(name);
    if (found != help->options.end()) return void(option.description(found->second));
  }
  throw std::logic_error("help.txt says nothing of " + title + " " + name);
}

/// Adds what help.txt says of every command, with the paths of the rigs of config/. Only who asks
/// for help needs it.
void finish_help(CLI::App& app, const HelpText& common) {
  if (CLI::Option* help = app.get_help_ptr()) help->description("print this help and exit");
  const std::string title = title_of(app);
  const HelpText own = help_of(title);
  if (!own.description.empty()) app.description(own.description);
  for (CLI::Option* option : app.get_options([](CLI::Option*) { return true; })) {
    describe(*option, own, common, title);
  }
  if (!own.examples.empty()) app.footer("Examples:\n" + own.examples);
  app.footer(
      replace_all(app.get_footer(), std::string(kConfigFolder) + "/", config_folder() + "/"));
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    finish_help(*command, common);
  }
}

std::vector<std::string> words_of(const CLI::App& app) {
  std::vector<std::string> words;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    words.push_back(command->get_name());
  }
  return words;
}

std::string with_suggestion(const std::string& sentence, const std::string& word,
                            const std::vector<std::string>& candidates) {
  const std::string near = nearest_word(word, candidates, word.size() / 3 + 2);
  return sentence + (near.empty() ? "" : "; did you mean " + near + "?");
}

std::ptrdiff_t num_positionals(const CLI::App& command) {
  const auto options = command.get_options();
  return std::count_if(options.begin(), options.end(),
                       [](const CLI::Option* option) { return option->get_positional(); });
}

/// Finds the command named by the leading words, for help and messages; `problem` gets a sentence
/// for a misspelt word.
const CLI::App* find_command(const CLI::App& app, int argc, char** argv, std::string& problem) {
  const CLI::App* command = &app;
  std::ptrdiff_t num_own = 0;  // positional arguments of a command
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const std::vector<std::string> words = words_of(*command);
    if (words.empty() || word.empty() || word.front() == '-') break;
    if (std::find(words.begin(), words.end(), word) == words.end()) {
      if (++num_own <= num_positionals(*command)) continue;  // its subcommand may follow
      problem = with_suggestion("there is no command \"" + word + "\"", word, words);
      break;
    }
    command = command->get_subcommand(word);
    num_own = 0;
  }
  return command;
}

/// Names a misspelt option with its nearest neighbour, or returns CLI11's own sentence.
std::string usage_problem(const CLI::App& command, const CLI::ParseError& error, int argc,
                          char** argv) {
  std::vector<std::string> options;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
  }
  for (int i = 1; i < argc; ++i) {
    const std::string word = std::string(argv[i]).substr(0, std::string(argv[i]).find('='));
    if (word.rfind("--", 0) != 0 || word.size() == 2) continue;
    if (std::find(options.begin(), options.end(), word) == options.end()) {
      return with_suggestion("there is no option " + word, word, options);
    }
  }
  return error.what();
}

int run_and_report(const Run& run, const std::string& title) {
  try {
    return run();
  } catch (const io::ConfigError& error) {
    for (const std::string& problem : error.problems()) {
      std::fprintf(stderr, "%s: %s\n", title.c_str(), problem.c_str());
    }
    return bus::kExitInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", title.c_str(), error.what());
    const bool is_of_content = dynamic_cast<const io::FileError*>(&error) != nullptr &&
                               dynamic_cast<const io::SystemError*>(&error) == nullptr;
    return is_of_content ? bus::kExitInput : bus::kExitRuntime;
  }
}

/// Converts `orchard help log info` to `orchard log info --help`.
std::vector<char*> with_help_option(int argc, char** argv) {
  static char help_option[] = "--help";
  std::vector<char*> words(argv, argv + argc);
  const bool explains = argc == 2 || (argc > 2 && argv[2][0] != '-');  // not its own help
  if (explains && std::string(argv[1]) == "help") {
    words.erase(words.begin() + 1);
    words.push_back(help_option);
  }
  return words;
}

}  // namespace

int run_command_line(int given_argc, char** given_argv) {
  std::vector<char*> words = with_help_option(given_argc, given_argv);
  const int argc = static_cast<int>(words.size());
  char** argv = words.data();
  CLI::App app{
      "Orchard Mapper: maps every tree of an orchard from a robot's laser scans and camera "
      "pictures.",
      "orchard"};
  set_up_help(app);
  app.require_subcommand(1);
  app.footer(
      "Start here:\n"
      "  orchard simulate --scene tubes --seed 1 --out out/tubes.lcm --truth out/truth.csv\n"
      "  orchard map out/tubes.lcm --out out/tubes\n"
      "  orchard evaluate out/tubes --truth out/truth.csv\n"
      "`orchard help COMMAND` explains a command with examples.\n"
      "Exit codes: 0 success, 1 failed or interrupted, 2 bad command line, 3 bad configuration or "
      "input file.");
  Run run;
  add_all_commands(app, run);
  add_version(app);
  CLI::App& help = add_subcommand(app, "help");
  help.description("Explain a command, for example: orchard help map");
  add_version(help);

  std::string problem;
  const CLI::App* command = find_command(app, argc, argv, problem);
  const std::string title = title_of(*command);
  if (problem.empty()) {
    try {
      app.parse(argc, argv);
      return run_and_report(run, title);
    } catch (const CLI::Success& success) {
      finish_help(app, help_of("options"));
      return app.exit(success);
    } catch (const CLI::ParseError& error) {
      problem = usage_problem(*command, error, argc, argv);
    }
  }
  std::fprintf(stderr, "%s: %s\nSee `%s --help`.\n", title.c_str(), problem.c_str(), title.c_str());
  return bus::kExitUsage;
}

}  // namespace orchard::cli
