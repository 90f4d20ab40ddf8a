// SPDX-License-Identifier: BSD-3-Clause
#include "farm/farm_tasks.hpp"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <map>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "text/number_text.hpp"

namespace orchard::farm {
namespace {

EVP_MD_CTX* of(const std::shared_ptr<void>& context) {
  return static_cast<EVP_MD_CTX*>(context.get());
}

void require(int result) {
  if (result != 1) throw std::runtime_error("libcrypto does not compute SHA-256 on this system");
}

constexpr std::size_t kDigits = 20;  ///< of a name; collisions are negligible among 1e9 results

/// Name of a result that depends only on `causes`.
std::string name_of(TaskKind kind, const std::vector<std::string>& causes) {
  std::string text = kind_text(kind);
  for (const std::string& cause : causes) text += "\n" + cause;
  return std::string(kind_text(kind)) + "-" + sha256_hex(text).substr(0, kDigits);
}

/// Tasks in order of insertion, identical ones once.
class TaskList {
 public:
  const std::string& add(FarmTask task) {
    const auto [place, is_new] = place_of_.try_emplace(task.name, tasks_.size());
    if (is_new) {
      tasks_.push_back(std::move(task));
      return tasks_.back().name;
    }
    FarmTask& known = tasks_[place->second];
    known.drives.insert(known.drives.end(), task.drives.begin(), task.drives.end());
    return known.name;
  }
  std::vector<FarmTask> take() { return std::move(tasks_); }

 private:
  std::vector<FarmTask> tasks_;
  std::map<std::string, std::size_t> place_of_;
};

using DrivesOfDate = std::vector<Drive>;

void add_date(const DrivesOfDate& drives, const FarmSettings& settings, const EditsOf& edits_of,
              std::vector<std::string>& dates, TaskList& tasks) {
  FarmTask date;
  date.kind = TaskKind::kDate;
  date.earlier = dates;
  date.drives = drives;
  for (const Drive& drive : drives) {
    const std::string check =
        tasks.add({TaskKind::kCheck,
                   name_of(TaskKind::kCheck, {settings.version, drive.log_digest}),
                   {},
                   {},
                   {drive}});
    const std::string map =
        tasks.add({TaskKind::kMap,
                   name_of(TaskKind::kMap, {settings.version, drive.log_digest, drive.rig_digest}),
                   {check},
                   {},
                   {drive}});
    // A log that is in the folder twice counts as one drive.
    if (std::find(date.needs.begin(), date.needs.end(), map) == date.needs.end()) {
      date.needs.push_back(map);
    }
  }
  std::vector<std::string> causes{settings.version, settings.any_place ? "any place" : "one frame",
                                  shortest_text(settings.max_offset_m),
                                  dates.empty() ? "" : dates.back()};
  causes.insert(causes.end(), date.needs.begin(), date.needs.end());
  if (edits_of && !dates.empty()) {
    const std::string edits = edits_of(dates.back());
    if (!edits.empty()) causes.push_back("edits " + edits);
  }
  date.name = name_of(TaskKind::kDate, causes);
  const std::string name = tasks.add(date);
  if (!dates.empty()) {
    tasks.add({TaskKind::kChanges,
               name_of(TaskKind::kChanges, {settings.version, name}),
               {name},
               dates,
               drives});
  }
  FarmTask report;
  report.kind = TaskKind::kReport;
  const Drive& any = drives.front();
  report.name = name_of(TaskKind::kReport, {settings.version, name, any.block, any.date,
                                            edits_of ? edits_of(name) : std::string()});
  report.needs = {name};
  report.drives = drives;
  if (!settings.publish_to.empty()) {
    FarmTask publish = report;
    publish.kind = TaskKind::kPublish;
    publish.name = name_of(TaskKind::kPublish,
                           {settings.version, name, any.block, any.date,
                            edits_of ? edits_of(name) : std::string(), settings.publish_to});
    tasks.add(std::move(publish));
  }
  tasks.add(std::move(report));
  dates.push_back(name);
}

}  // namespace

Sha256::Sha256()
    : context_(EVP_MD_CTX_new(), [](void* p) { EVP_MD_CTX_free(static_cast<EVP_MD_CTX*>(p)); }) {
  require(EVP_DigestInit_ex(of(context_), EVP_sha256(), nullptr));
}

void Sha256::add(const void* bytes, std::size_t size) {
  require(EVP_DigestUpdate(of(context_), bytes, size));
}

std::string Sha256::hex() {
  std::array<unsigned char, 32> digest{};
  require(EVP_DigestFinal_ex(of(context_), digest.data(), nullptr));
  std::string text;
  for (const unsigned char byte : digest) {
    text += "0123456789abcdef"[byte >> 4];
    text += "0123456789abcdef"[byte & 15];
  }
  return text;
}

std::string sha256_hex(std::string_view text) {
  Sha256 digest;
  digest.add(text.data(), text.size());
  return digest.hex();
}

const char* kind_text(TaskKind kind) {
  switch (kind) {
    case TaskKind::kCheck:
      return "check";
    case TaskKind::kMap:
      return "map";
    case TaskKind::kDate:
      return "date";
    case TaskKind::kChanges:
      return "changes";
    case TaskKind::kReport:
      return "report";
    case TaskKind::kPublish:
      break;
  }
  return "publish";
}

std::vector<FarmTask> tasks_of(std::vector<Drive> drives, const FarmSettings& settings,
                               const EditsOf& edits_of) {
  std::map<std::string, std::map<std::string, DrivesOfDate>> blocks;
  std::sort(drives.begin(), drives.end(), [](const Drive& a, const Drive& b) {
    return std::tie(a.block, a.date, a.robot, a.name) < std::tie(b.block, b.date, b.robot, b.name);
  });
  for (Drive& drive : drives) blocks[drive.block][drive.date].push_back(std::move(drive));
  TaskList tasks;
  for (const auto& [block, by_date] : blocks) {
    std::vector<std::string> dates;
    for (const auto& [date, drives_of_date] : by_date) {
      add_date(drives_of_date, settings, edits_of, dates, tasks);
    }
  }
  return tasks.take();
}

}  // namespace orchard::farm
