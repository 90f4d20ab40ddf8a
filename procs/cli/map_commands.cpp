// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>

#include "cli/add_command.hpp"
#include "cli/farm/farm.hpp"
#include "cli/maps/maps.hpp"
#include "geometry/angles.hpp"

namespace orchard::cli {

void add_alignment_options(CLI::App& command, mapping::MapAlignmentConfig& c) {
  add_limited(command, "--max-offset", c.offset_max_m, 0.01, 100.0);
  const double rad_per_deg = geometry::kPi / 180.0;
  command
      .add_option_function<double>(
          "--max-turn-rad", [&c, rad_per_deg](double rad) { c.turn_max_deg = rad / rad_per_deg; },
          "max rotation between the maps [rad]")
      ->check(CLI::Range(0.0, 3.15))
      ->default_str("0.175");
  command.add_flag("--any-place", c.any_place);
}

namespace {

void add_reach_option(CLI::App& command, double& reach_m) {
  command.add_option("--reach", reach_m)->check(CLI::Range(0.5, 500.0));
}

void declare(CLI::App& command, CompareOptions& o) {
  add_required(command, "earlier", o.earlier_path, "FOLDER|CSV");
  add_required(command, "later", o.later_path, "FOLDER|CSV");
  add_value(command, "--out", o.out_folder, "DIR");
  command.add_flag("--as-mapped", o.as_mapped);
  command.add_flag("--json", o.json);
  add_alignment_options(command, o.alignment);
  add_reach_option(command, o.reach_m);
  command.add_flag("--assume-seen", o.comparison.assume_seen);
  command.add_flag("--objects", o.comparison.with_objects);
}

void declare(CLI::App& command, MergeOptions& o) {
  add_required(command, "maps", o.map_paths, "FOLDER|CSV...")->expected(1, 1000);
  add_required(command, "--out", o.out_folder, "DIR");
  add_value(command, "--previous", o.previous_paths, "FOLDER|CSV")->allow_extra_args(false);
  command.add_flag("--leave-out", o.leave_out);
  add_value(command, "--config", o.config_path, "FILE");
  add_alignment_options(command, o.alignment);
  add_reach_option(command, o.reach_m);
}

void declare(CLI::App& command, ViewOptions& o) {
  add_required(command, "path", o.paths, "LOG...|FOLDER");
  add_value(command, "--config", o.config_path, "FILE");
  add_value(command, "--listen", o.listen, "ADDRESS:PORT");
  add_value(command, "--token-file", o.token_file, "FILE");
  command.add_flag("--edit", o.edit);
  command.add_flag("--open,!--no-browser", o.open);
}

using mapping::CorrectionKind;

/// The subcommands of `orchard edit`; they share one options struct, since only one can be
/// given.
class EditCommands {
 public:
  EditCommands(CLI::App& edit, Run& run, std::shared_ptr<EditOptions> options)
      : edit_(edit), run_(run), options_(std::move(options)) {}

  CLI::App& add(CorrectionKind kind) {
    CLI::App& command = add(mapping::correction_word(kind), run_edit, kind);
    add_value(command, "--who", options_->edit.who, "NAME");
    if (kind != CorrectionKind::kNote) add_value(command, "--note", options_->edit.note, "TEXT");
    return command;
  }
  CLI::App& add(const char* name, int (*function)(const EditOptions&),
                CorrectionKind kind = CorrectionKind::kNote) {
    CLI::App& command = add_subcommand(edit_, name);
    add_required(command, "map", options_->map_folder, "FOLDER");
    on_command(command, [&run = run_, &edit = edit_, options = options_, function, kind] {
      options->edit.kind = kind;
      run = [&edit, options, function] { return run_command(edit, function, *options); };
    });
    return command;
  }

  void tree(CLI::App& command) {
    add_required(command, "tree", options_->edit.trees, "ID|ROW/TREE")
        ->expected(1)
        ->allow_extra_args(false);
  }
  CLI::Option* at(CLI::App& command, int num_numbers) {
    return add_value(command, "--at", options_->at_m, "X Y")->expected(num_numbers);
  }
  void class_word(CLI::App& command, const char* name) {
    command.add_option(name, options_->edit.class_word)->check(CLI::IsMember({"tree", "object"}));
  }

  EditOptions& options() { return *options_; }

 private:
  CLI::App& edit_;
  Run& run_;
  std::shared_ptr<EditOptions> options_;
};

void add_tree_words(EditCommands& words) {
  words.tree(words.add(CorrectionKind::kDelete));
  CLI::App& add = words.add(CorrectionKind::kAdd);
  add_value(add, "gap", words.options().edit.trees, "ROW/TREE")
      ->expected(1)
      ->allow_extra_args(false);
  words.at(add, 2);
  words.class_word(add, "--class");
  add.add_option("--width", words.options().edit.width_m)->check(CLI::Range(0.001, 100.0));
  CLI::App& move = words.add(CorrectionKind::kMove);
  words.tree(move);
  words.at(move, 2)->required();
  CLI::App& label = words.add(CorrectionKind::kClass);
  words.tree(label);
  label.add_option("class", words.options().edit.class_word)
      ->required()
      ->check(CLI::IsMember({"tree", "object"}));
  CLI::App& merge = words.add(CorrectionKind::kMerge);
  add_required(merge, "trees", words.options().edit.trees, "ID|ROW/TREE...")->expected(2, 100);
  CLI::App& split = words.add(CorrectionKind::kSplit);
  words.tree(split);
  words.at(split, 4)->required()->type_name("X1 Y1 X2 Y2");
}

void add_number_words(EditCommands& words) {
  CLI::App& row = words.add(CorrectionKind::kRowName);
  row.add_option("row", words.options().edit.row)->required();
  row.add_option("name", words.options().edit.name)->required();
  CLI::App& renumber = words.add(CorrectionKind::kRenumber);
  words.tree(renumber);
  renumber.add_option("--row", words.options().edit.row)->required();
  renumber.add_option("--position", words.options().edit.position)
      ->required()
      ->check(CLI::Range(0, 1000000));
  CLI::App& note = words.add(CorrectionKind::kNote);
  words.tree(note);
  add_required(note, "text", words.options().edit.note, "TEXT");
}

void add_history_words(EditCommands& words) {
  for (const auto kind : {CorrectionKind::kUndo, CorrectionKind::kRedo}) {
    words.add(kind).add_option("number", words.options().edit.of)->check(CLI::Range(1, 2147483646));
  }
  words.add("list", run_edit_list).add_flag("--json", words.options().json);
  words.add("check", run_edit_check).add_flag("--json", words.options().json);
  add_required(words.add("background", run_edit_background), "picture",
               words.options().picture_path, "FILE");
  add_required(words.add("apply", run_edit_apply), "--out", words.options().out_folder, "DIR");
}

void add_edit(CLI::App& app, Run& run) {
  CLI::App& edit = add_group(app, "edit");
  EditCommands words(edit, run, std::make_shared<EditOptions>());
  add_tree_words(words);
  add_number_words(words);
  add_history_words(words);
  for (CLI::App* word : edit.get_subcommands([](CLI::App*) { return true; })) add_version(*word);
}

void add_plan_options(CLI::App& command, io::PlanFileOptions& file,
                      mapping::PlanMatchConfig& match) {
  add_value(command, "--layer", file.layer, "NAME");
  add_value(command, "--row-field", file.row_field, "NAME");
  add_value(command, "--tree-field", file.tree_field, "NAME");
  add_value(command, "--crs", file.crs, "EPSG:CODE");
  command.add_option("--spacing", file.spacing_m)->check(CLI::Range(0.2, 100.0));
  add_limited(command, "--tolerance", match.tolerance_m, 0.01, 10.0);
  command.add_option("--placement", match.placement)->check(CLI::Range(1, 100));
}

void declare(CLI::App& command, PlanOptions& o) {
  add_required(command, "plan", o.plan_path, "FILE");
  add_value(command, "--map", o.map_path, "FOLDER|CSV");
  add_value(command, "--out", o.out_path, "DIR|GEOJSON");
  add_plan_options(command, o.file, o.match);
  add_alignment_options(command, o.match.alignment);
  auto* json = command.add_flag("--json", o.json);
  auto* csv = command.add_flag("--csv", o.csv)->excludes("--map", "--out")->excludes(json);
  add_value(command, "--datum", o.datum_deg, "LAT LON")
      ->expected(2)
      ->check(CLI::Range(-180.0, 180.0))
      ->needs(csv);
}

void declare(CLI::App& command, PublishOptions& o) {
  add_required(command, "map", o.map_path, "FOLDER|CSV");
  add_required(command, "--to", o.url, "URL");
  add_required(command, "--block", o.block, "NAME");
  add_value(command, "--date", o.date, "YYYY-MM-DD");
  command.add_flag("--as-mapped", o.as_mapped);
  command.add_flag("--json", o.json);
}

void declare(CLI::App& command, ReportOptions& o) {
  add_required(command, "map", o.map_path, "FOLDER|CSV");
  add_value(command, "--previous", o.previous_path, "FOLDER");
  add_value(command, "--plan", o.plan_path, "FILE");
  add_value(command, "--out", o.out_folder, "DIR");
  add_value(command, "--name", o.name, "TEXT");
  add_checked(command, "--language", o.language, CLI::IsMember({"en", "es"}));
  command.add_flag("--as-mapped", o.as_mapped);
  command.add_flag("--json", o.json);
  add_plan_options(command, o.plan_file, o.plan_match);
  add_alignment_options(command, o.alignment);
}

void declare(CLI::App& command, ExportOptions& o) {
  add_required(command, "map", o.map_path, "FOLDER|CSV");
  command.add_option("--format", o.format)
      ->required()
      ->check(CLI::IsMember({"geojson", "kml", "shp", "dxf", "csv", "flatgeobuf", "gpkg", "gpx",
                             "nav2", "tmap2", "grid", "kitti"}));
  add_required(command, "--out", o.out_path, "FILE");
  command.add_option("--layer", o.layer)
      ->check(CLI::IsMember({"landmarks", "extents", "keep-outs", "path", "rows", "gaps", "aisles",
                             "headlands", "nodes"}));
  command.add_option("--keep-out", o.keep_out_m)->check(CLI::Range(0.01, 100.0));
  command.add_flag("--as-mapped", o.as_mapped);
  command.add_flag("--overwrite", o.overwrite);
  command.add_flag("--json", o.json);
}

void declare(CLI::App& command, TasksOptions& o) {
  add_required(command, "map", o.map_path, "FOLDER|CSV");
  add_required(command, "--out", o.out_path, "FILE");
  add_value(command, "--ticked", o.ticked_path, "FILE");
  add_value(command, "--previous", o.previous_path, "FOLDER");
  command.add_flag("--as-mapped", o.as_mapped);
  command.add_flag("--overwrite", o.overwrite);
  command.add_flag("--json", o.json);
  add_alignment_options(command, o.alignment);
}

void declare(CLI::App& command, ImportEditsOptions& o) {
  add_required(command, "map", o.map_folder, "FOLDER");
  add_required(command, "edited", o.edited_path, "GPKG");
  add_value(command, "--who", o.who, "NAME");
  command.add_flag("--keep-missing", o.keep_missing);
  command.add_flag("--dry-run", o.dry_run);
  command.add_flag("--json", o.json);
}

void declare(CLI::App& command, FarmInitOptions& o) {
  add_required(command, "farm", o.folder, "DIR");
  command.add_flag("--renew", o.renew);
}

void declare(CLI::App& command, FarmAddOptions& o) {
  add_required(command, "farm", o.folder, "DIR");
  add_required(command, "log", o.log_paths, "LOG...");
  add_required(command, "--block", o.block, "NAME");
  add_required(command, "--date", o.date, "YYYY-MM-DD");
  add_required(command, "--robot", o.robot, "NAME");
  command.add_flag("--link", o.link);
}

void declare(CLI::App& command, FarmRunOptions& o) {
  add_required(command, "farm", o.folder, "DIR");
  add_value(command, "--profile", o.profile, "NAME")->capture_default_str();
  command.add_option("--cores", o.cores)->check(CLI::PositiveNumber);
  command.add_flag("--keep-version", o.keep_version);
  command.add_flag("--dry-run", o.dry_run);
}

void declare(CLI::App& command, FarmStatusOptions& o) {
  add_required(command, "farm", o.folder, "DIR");
  command.add_flag("--json", o.json);
}

void declare(CLI::App& command, FarmOptions& o) { add_required(command, "farm", o.folder, "DIR"); }

void declare(CLI::App& command, FarmRetryOptions& o) {
  add_required(command, "farm", o.folder, "DIR");
  add_value(command, "name", o.name, "NAME");
}

void declare(CLI::App& command, FarmStepOptions& o) {
  command.add_option("name", o.name)->required();
  command.add_option("command", o.command);
}

}  // namespace

void add_map_commands(CLI::App& app, Run& run) {
  add_command(app, run, "compare", run_compare, declare);
  add_command(app, run, "merge", run_merge, declare);
  add_command(app, run, "view", run_view, declare);
  add_edit(app, run);
  add_command(app, run, "plan", run_plan, declare);
  add_command(app, run, "report", run_report, declare);
  add_command(app, run, "publish", run_publish, declare);
  add_command(app, run, "export", run_export, declare);
  add_command(app, run, "tasks", run_tasks, declare);
  add_command(app, run, "import-edits", run_import_edits, declare);
}

void add_farm(CLI::App& app, Run& run) {
  CLI::App& farm = add_group(app, "farm");
  add_command(farm, run, "init", run_farm_init, declare);
  add_command(farm, run, "add", run_farm_add, declare);
  add_command(farm, run, "run", run_farm_run, declare);
  add_command(farm, run, "status", run_farm_status, declare);
  add_command(farm, run, "publish", run_farm_publish, declare);
  add_command(farm, run, "verify", run_farm_verify, declare);
  add_command(farm, run, "retry", run_farm_retry, declare);
  add_command(farm, run, "clean", run_farm_clean, declare);
  add_command(farm, run, "step", run_farm_step, declare);
}

}  // namespace orchard::cli
