// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "bus/process/process.hpp"
#include "cli/farm/farm.hpp"
#include "cli/farm/farm_folder.hpp"
#include "farm/drive_pieces.hpp"
#include "io/atomic_file.hpp"
#include "io/file_error.hpp"
#include "io/folder.hpp"
#include "io/map/corrections_file.hpp"
#include "text/date_problem.hpp"
#include "text/encoded_text.hpp"

namespace orchard::cli {
namespace {

namespace fs = std::filesystem;
using farm::FarmTask;

void require_name(const std::string& option, const std::string& name) {
  const std::string problem = name_problem(name);
  if (!problem.empty()) {
    throw io::FileError(option + " " + printable_text(name) + ": " + problem + "; give another");
  }
}

/// Atomically points a symbolic link to another folder.
void point_to(const std::string& link, const std::string& target) {
  fs::create_directories(fs::path(link).parent_path());
  const std::string made = link + ".new";
  std::error_code error;
  fs::remove(made, error);
  fs::create_directory_symlink(target, made);
  fs::rename(made, link);
}

/// A link in maps/, changes/ or reports/ and the result that it names.
struct PublishedLink {
  std::string link, result;
};

std::vector<PublishedLink> published_links(const FarmFolder& farm) {
  std::vector<PublishedLink> links;
  for (const char* folder : {"maps", "changes", "reports"}) {
    const std::string root = farm.path(folder);
    for (const std::string& block : io::folder_names(root)) {
      for (const std::string& date : io::folder_names(root + "/" + block)) {
        const std::string link = root + "/" + block + "/" + date;
        if (!fs::is_symlink(link)) continue;
        links.push_back({link, fs::read_symlink(link).filename().string()});
      }
    }
  }
  return links;
}

/// The finished results that a retry of `name` (a result or the title of a step; empty: all that
/// was set aside) removes: these and all that was made from them.
std::vector<std::string> results_to_retry(const FarmFolder& farm, const std::string& name) {
  std::set<std::string> gone;
  std::vector<std::string> finished;
  for (const FarmTask& task : farm.tasks_of(farm.read())) {
    const auto state = farm.state_of(task.name);
    const bool is_aside = state && !state->is_good;
    const bool is_asked = task.name == name || (is_aside && (name.empty() || task.title() == name));
    const auto is_gone = [&gone](const std::string& need) { return gone.count(need) > 0; };
    if (!is_asked && std::none_of(task.needs.begin(), task.needs.end(), is_gone) &&
        std::none_of(task.earlier.begin(), task.earlier.end(), is_gone)) {
      continue;
    }
    gone.insert(task.name);
    if (state) finished.push_back(task.name);
  }
  if (gone.empty() && !name.empty()) {
    throw io::FileError(name + ": nothing of this name was set aside; see `orchard farm status`");
  }
  return finished;
}

/// Removes what the steps left in a folder of work/ under other names than those kept.
void remove_others(const std::string& folder, const std::set<std::string>& kept) {
  for (const std::string& name : io::folder_names(folder)) {
    if (kept.count(fs::path(name).stem().string()) == 0) fs::remove(folder + "/" + name);
  }
}

}  // namespace

int run_farm_init(const FarmInitOptions& options) {
  for (const char* folder : {"logs", "rigs", "plans"})
    io::make_folder(options.folder + "/" + folder);
  for (int i = 0; i < kNumFarmFiles; ++i) {
    const std::string path = options.folder + "/" + kFarmFiles[i].name;
    const bool is_users = std::string(kFarmFiles[i].name) == "farm.yaml";
    if (fs::exists(path) && (is_users || !options.renew)) {
      std::printf("%s exists and was not changed\n", path.c_str());
      continue;
    }
    io::make_folder(fs::path(path).parent_path().string());
    io::write_file_atomically(path, kFarmFiles[i].text);
    if (path.size() > 3 && path.substr(path.size() - 3) == ".sh") {
      fs::permissions(path, fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec,
                      fs::perm_options::add);
    }
  }
  std::printf(
      "farm created in %s. Put logs into logs/BLOCK/DATE/ROBOT/ (or run `orchard farm add %s LOG "
      "--block B --date D --robot R`),\n"
      "  and rigs that replace those stored in the logs into rigs/ROBOT.yaml; then run `orchard "
      "farm run %s`\n",
      options.folder.c_str(), options.folder.c_str(), options.folder.c_str());
  return bus::kExitOk;
}

int run_farm_add(const FarmAddOptions& options) {
  const FarmFolder farm(options.folder);
  require_name("--block", options.block);
  require_name("--robot", options.robot);
  const std::string problem = date_problem(options.date);
  if (!problem.empty()) throw io::FileError("--date " + options.date + " " + problem);
  const std::string folder =
      farm.path("logs/" + options.block + "/" + options.date + "/" + options.robot);
  for (const std::string& log : options.log_paths) {
    const std::string name = fs::path(log).filename().string();
    if (!name_problem(name).empty() || !farm::is_log_name(name)) {
      throw io::FileError(log +
                          ": not the name of a log in a farm; rename it to NAME.lcm (parts of a "
                          "split log: NAME-000.lcm ... or NAME.lcm.00 ...)");
    }
    const std::string place = folder + "/" + name;
    if (fs::exists(place)) {
      if (digest_of_files({place}) != digest_of_files({log})) {
        throw io::FileError(place + " exists already and differs from " + log);
      }
      std::printf("%s exists already with the same content\n", place.c_str());
      continue;
    }
    io::make_folder(folder);
    if (options.link) {
      fs::create_symlink(fs::absolute(log), place);
      std::printf("%s\n", place.c_str());
      continue;
    }
    // Atomic, so that a concurrent run of the farm never reads an incomplete log.
    io::replace_file_atomically(place, [&](const std::string& temporary) {
      std::error_code error;
      fs::copy_file(log, temporary, fs::copy_options::overwrite_existing, error);
      if (error) throw io::FileError(log + " could not be copied (" + error.message() + ")");
    });
    std::printf("%s\n", place.c_str());
  }
  return bus::kExitOk;
}

int run_farm_publish(const FarmOptions& options) {
  const FarmFolder farm(options.folder);
  const FarmContent content = farm.read();
  int num_maps = 0, num_changes = 0, num_reports = 0, num_open = 0, num_kept = 0;
  for (const farm::FarmTask& task : farm.tasks_of(content)) {
    const bool is_date = task.kind == farm::TaskKind::kDate;
    const bool is_report = task.kind == farm::TaskKind::kReport;
    if (!is_date && !is_report && task.kind != farm::TaskKind::kChanges) continue;
    const auto state = farm.state_of(task.name);
    num_open += state ? 0 : 1;
    if (!state || !state->is_good) continue;
    ++(is_date ? num_maps : is_report ? num_reports : num_changes);
    std::set<std::string> places;  // equal dates of several blocks share one result
    for (const farm::Drive& drive : task.drives) places.insert(drive.block + "/" + drive.date);
    for (const std::string& place : places) {
      const std::string link = farm.path((is_date     ? "maps/"
                                          : is_report ? "reports/"
                                                      : "changes/") +
                                         place);
      std::error_code error;
      const std::string before = fs::read_symlink(link, error).filename().string();
      if (is_date && before != task.name && !farm.edits_of(before).empty()) {
        std::fprintf(stderr,
                     "orchard farm publish: warning: %s was corrected by hand and is not replaced; "
                     "the newer map is %s: correct it, too (`orchard edit`), then remove %s/%s\n",
                     link.c_str(), farm.path("results/" + task.name).c_str(),
                     farm.path("results/" + before).c_str(), io::kCorrectionsFile);
        ++num_kept;
        continue;
      }
      point_to(link, "../../results/" + task.name);
    }
  }
  std::printf("%d maps in %s, %d comparisons in %s, %d reports in %s\n", num_maps,
              farm.path("maps").c_str(), num_changes, farm.path("changes").c_str(), num_reports,
              farm.path("reports").c_str());
  print_notes("publish", content);
  if (num_open > 0) {
    std::fprintf(
        stderr, "orchard farm publish: note: %d results do not exist yet; run `orchard farm run`\n",
        num_open);
  }
  return num_kept == 0 ? bus::kExitOk : bus::kExitRuntime;
}

int run_farm_verify(const FarmOptions& options) {
  const FarmFolder farm(options.folder);
  int num_results = 0, num_damaged = 0;
  for (const std::string& name : farm.result_names()) {
    if (name.front() == '.') continue;
    ++num_results;
    const std::string damage = farm.damage_of(name);
    if (damage.empty()) continue;
    ++num_damaged;
    std::printf("results/%s: %s; remove it with `orchard farm retry %s %s`\n", name.c_str(),
                damage.c_str(), farm.root().c_str(), name.c_str());
  }
  for (const PublishedLink& published : published_links(farm)) {
    if (fs::exists(farm.path("results/" + published.result))) continue;
    ++num_damaged;
    std::printf("%s: results/%s was deleted; run `orchard farm run` and `orchard farm publish`\n",
                published.link.c_str(), published.result.c_str());
  }
  std::printf("%d results, %d of them damaged or deleted\n", num_results, num_damaged);
  return num_damaged == 0 ? bus::kExitOk : bus::kExitInput;
}

int run_farm_retry(const FarmRetryOptions& options) {
  const FarmFolder farm(options.folder);
  const RunLock lock(farm);
  const std::vector<std::string> results = results_to_retry(farm, options.name);
  for (const std::string& name : results) {
    if (farm.edits_of(name).empty()) continue;
    throw io::FileError(farm.path("results/" + name) +
                        " depends on it and was corrected by hand; the corrections would be lost: "
                        "move its " +
                        io::kCorrectionsFile + " away first");
  }
  for (const std::string& name : results) fs::remove_all(farm.path("results/" + name));
  std::printf("%zu results removed; `orchard farm run %s` makes them again\n", results.size(),
              farm.root().c_str());
  return bus::kExitOk;
}

int run_farm_clean(const FarmOptions& options) {
  const FarmFolder farm(options.folder);
  const RunLock lock(farm);
  const FarmContent content = farm.read();
  if (content.drives.empty()) {
    throw io::FileError(farm.path("logs") +
                        " has no drive, so all results would go; is its disk mounted?");
  }
  std::set<std::string> kept, rigs;
  for (const FarmTask& task : farm.tasks_of(content)) kept.insert(task.name);
  for (const PublishedLink& published : published_links(farm)) kept.insert(published.result);
  for (const auto& [path, text] : content.rig_copies) rigs.insert(fs::path(path).stem().string());
  remove_unfinished(farm, true);
  int num = 0;
  for (const std::string& name : farm.result_names()) {
    if (kept.count(name) > 0 || name.front() == '.') continue;
    if (!farm.edits_of(name).empty()) {
      std::printf("results/%s is kept: it was corrected by hand\n", name.c_str());
      continue;
    }
    fs::remove_all(farm.path("results/" + name));
    ++num;
  }
  for (const char* folder : {"work/cost", "work/output", "work/slurm"}) {
    remove_others(farm.path(folder), kept);
  }
  remove_others(farm.path("work/rigs"), rigs);
  std::printf("%d results removed that no step needs and no link names\n", num);
  return bus::kExitOk;
}

}  // namespace orchard::cli
