// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "cli/add_command.hpp"
#include "cli/growers/edit.hpp"

namespace orchard::cli {
namespace {

using mapping::CorrectionKind;

/// The subcommands of `orchard edit MAP`; they share one options struct, since only one can be
/// given.
class EditCommands {
 public:
  EditCommands(CLI::App& edit, Run& run, std::shared_ptr<EditOptions> options)
      : edit_(edit), run_(run), options_(std::move(options)) {}

  CLI::App& add(CorrectionKind kind, const char* description, const char* examples) {
    CLI::App& command =
        add_subcommand(edit_, mapping::correction_word(kind), description, examples);
    on_command(command, [&run = run_, options = options_, kind] {
      options->kind = kind;
      run = [options] { return run_edit(*options); };
    });
    add_value(command, "--who", options_->who, "NAME",
              "name of the person who corrects [the current user]");
    if (kind != CorrectionKind::kNote) {
      add_value(command, "--note", options_->note, "TEXT", "reason of the correction");
    }
    return command;
  }
  CLI::App& add_reader(const char* name, const char* description, const char* examples,
                       int (*function)(const EditOptions&)) {
    CLI::App& command = add_subcommand(edit_, name, description, examples);
    on_command(command, [&run = run_, options = options_, function] {
      run = [options, function] { return function(*options); };
    });
    return command;
  }

  void tree(CLI::App& command) {
    add_required(command, "tree", options_->tree, "ID|ROW/TREE",
                 "id (17) or row/tree (3/14) of the landmark");
  }
  CLI::Option* at(CLI::App& command, int num_numbers, const char* description) {
    return add_value(command, "--at", options_->at_m, "X Y", description)->expected(num_numbers);
  }
  void class_word(CLI::App& command, const char* name) {
    command.add_option(name, options_->class_word, "class of the landmark: tree or object")
        ->check(CLI::IsMember({"tree", "object"}));
  }

  EditOptions& options() { return *options_; }

 private:
  CLI::App& edit_;
  Run& run_;
  std::shared_ptr<EditOptions> options_;
};

void add_tree_words(EditCommands& words) {
  words.tree(words.add(CorrectionKind::kDelete, "Delete a landmark that does not exist",
                       "  orchard edit out/drive delete 17 --who Ana --note \"a shadow\"\n"));
  CLI::App& add = words.add(CorrectionKind::kAdd, "Add a tree or object that the map lacks",
                            "  orchard edit out/drive add 3/14            (in the gap of row 3)\n"
                            "  orchard edit out/drive add --at 12.5 3.0 --width 0.12\n"
                            "  orchard edit out/drive add --at 1.0 -4.2 --class object\n");
  add_value(add, "gap", words.options().tree, "ROW/TREE", "row/tree of a gap in a row");
  words.at(add, 2, "position [m, map frame]");
  words.class_word(add, "--class");
  add.add_option("--width", words.options().width_m, "width of the trunk, if measured [m]")
      ->check(CLI::Range(0.001, 100.0));
  CLI::App& move = words.add(CorrectionKind::kMove, "Move a landmark",
                             "  orchard edit out/drive move 17 --at 12.5 3.0\n");
  words.tree(move);
  words.at(move, 2, "true position [m, map frame]")->required();
  CLI::App& label = words.add(CorrectionKind::kClass, "Change the class of a landmark",
                              "  orchard edit out/drive class 17 object\n");
  words.tree(label);
  label.add_option("class", words.options().class_word, "true class: tree or object")
      ->required()
      ->check(CLI::IsMember({"tree", "object"}));
  CLI::App& merge = words.add(
      CorrectionKind::kMerge, "Merge landmarks that are one tree or object",
      "  orchard edit out/drive merge 17 18\n"
      "The first keeps its id; the position is that of the landmark with the most observations.\n");
  add_required(merge, "trees", words.options().trees, "ID|ROW/TREE...",
               "ids (17) or row/tree (3/14) of the landmarks")
      ->expected(2, 100);
  CLI::App& split =
      words.add(CorrectionKind::kSplit, "Split a landmark that is two trees or objects",
                "  orchard edit out/drive split 17 --at 12.1 3.0 12.9 3.0\n"
                "The landmark at the first position keeps the id.\n");
  words.tree(split);
  words.at(split, 4, "positions of both [m, map frame]")->required()->type_name("X1 Y1 X2 Y2");
}

void add_number_words(EditCommands& words) {
  CLI::App& row = words.add(CorrectionKind::kRowName, "Name a row",
                            "  orchard edit out/drive row 3 \"by the road\"\n");
  row.add_option("row", words.options().row, "number of the row, or its current name")->required();
  row.add_option("name", words.options().name, "new name of the row")->required();
  CLI::App& renumber =
      words.add(CorrectionKind::kRenumber, "Change the row and the number of a tree",
                "  orchard edit out/drive renumber 17 --row 3 --position 14\n");
  words.tree(renumber);
  renumber.add_option("--row", words.options().row, "number or name of the row")->required();
  renumber
      .add_option("--position", words.options().position, "number of the tree in its row; 0 = none")
      ->required()
      ->check(CLI::Range(0, 1000000));
  CLI::App& note = words.add(CorrectionKind::kNote, "Attach a note to a landmark",
                             "  orchard edit out/drive note 3/14 \"grafted in March\"\n");
  words.tree(note);
  add_required(note, "text", words.options().note, "TEXT", "the note, one line");
}

void add_history_words(EditCommands& words) {
  for (const auto kind : {CorrectionKind::kUndo, CorrectionKind::kRedo}) {
    const bool undoes = kind == CorrectionKind::kUndo;
    CLI::App& command = words.add(
        kind, undoes ? "Undo a correction" : "Redo an undone correction",
        undoes
            ? "  orchard edit out/drive undo         (the last)\n  orchard edit out/drive undo 7\n"
            : "  orchard edit out/drive redo         (what was undone last)\n");
    command.add_option("number", words.options().of, "number of the correction [the last]")
        ->check(CLI::Range(1, 2147483646));
  }
  CLI::App& list = words.add_reader("list", "List all corrections and whether each was applied",
                                    "  orchard edit out/drive list --json\n", run_edit_list);
  list.add_flag("--json", words.options().json, "print JSON");
  CLI::App& check = words.add_reader(
      "check", "List corrections that conflict with the map; exit code 3 if there are any",
      "  orchard edit out/drive check && echo sound\n", run_edit_check);
  check.add_flag("--json", words.options().json, "print JSON");
  CLI::App& apply = words.add_reader(
      "apply", "Write the corrected map to a new folder",
      "  orchard edit out/drive apply --out out/corrected     (map.html, map.gpkg, map.csv ...)\n",
      run_edit_apply);
  add_required(apply, "--out", words.options().out_folder, "DIR",
               "folder for the map; created if it does not exist");
}

}  // namespace

void add_growers(CLI::App& app, Run& run) {
  const auto options = std::make_shared<EditOptions>();
  CLI::App& edit = add_subcommand(
      app, "edit", "Correct a map by hand; corrections are kept when the orchard is mapped again",
      "  orchard edit out/drive delete 17 --note \"a shadow\"\n"
      "  orchard edit out/drive add 3/14\n"
      "  orchard edit out/drive list\n"
      "Corrections are saved in corrections.jsonl beside the map; the map itself is not changed.\n"
      "`orchard map --previous` applies them to the next map by id and position, and reports "
      "conflicts.\n");
  add_required(edit, "map", options->map_folder, "FOLDER", "map folder");
  edit.require_subcommand(1);
  EditCommands words(edit, run, options);
  add_tree_words(words);
  add_number_words(words);
  add_history_words(words);
}

}  // namespace orchard::cli
