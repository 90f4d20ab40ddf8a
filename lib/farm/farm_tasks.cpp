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

/// Name of a result that depends only on `causes`.
std::string name_of(TaskKind kind, const std::vector<std::string>& causes) {
  std::string text = kind_text(kind);
  for (const std::string& cause : causes) text += "\n" + cause;
  return std::string(kind_text(kind)) + "-" + sha256_hex(text).substr(0, kNameDigits);
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

/// The steps of one block, date by date.
class BlockTasks {
 public:
  BlockTasks(const FarmSettings& settings, const EditsOf& edits_of, TaskList& tasks)
      : settings_(settings), edits_of_(edits_of), tasks_(tasks) {}

  void add_date(const DrivesOfDate& drives) {
    FarmTask date = begin(TaskKind::kDate, drives);
    for (const Drive& drive : drives) add_map(drive, date.needs);
    for (const Drive& drive : drives) max_offset_m_ = std::max(max_offset_m_, drive.max_offset_m);
    date.max_offset_m = settings_.max_offset_m.value_or(max_offset_m_);
    std::vector<std::string> causes{settings_.any_place ? "any place" : "one frame",
                                    shortest_text(date.max_offset_m),
                                    dates_.empty() ? "" : dates_.back()};
    causes.insert(causes.end(), date.needs.begin(), date.needs.end());
    if (!dates_.empty()) causes.push_back("edits " + edits(dates_.back()));
    const std::string name = add(date, causes);
    const std::vector<std::string> causes_of_page{name, edits(name)};
    if (!dates_.empty()) {
      FarmTask changes = begin(TaskKind::kChanges, drives);
      changes.needs = {name};
      changes.max_offset_m = date.max_offset_m;
      add(changes, causes_of_page);
    }
    for (const TaskKind kind : {TaskKind::kReport, TaskKind::kPublish}) {
      if (kind == TaskKind::kPublish && settings_.publish_to.empty()) continue;
      FarmTask page{kind, {}, {name}, {}, drives};
      add(page, {name, edits(name), drives.front().block, drives.front().date,
                 kind == TaskKind::kPublish ? settings_.publish_to : std::string()});
    }
    dates_.push_back(name);
  }

 private:
  /// A step that also reads the latest of the previous dates that has a map.
  FarmTask begin(TaskKind kind, const DrivesOfDate& drives) const {
    return {kind, {}, {}, dates_, drives};
  }

  std::string edits(const std::string& date) const { return edits_of_ ? edits_of_(date) : ""; }

  /// A log that is in the folder twice counts as one drive.
  void add_map(const Drive& drive, std::vector<std::string>& needs) {
    const std::string map =
        add({TaskKind::kMap, {}, {}, {}, {drive}}, {drive.log_digest, drive.rig_digest});
    if (std::find(needs.begin(), needs.end(), map) == needs.end()) needs.push_back(map);
  }

  const std::string& add(FarmTask task, std::vector<std::string> causes) {
    causes.insert(causes.begin(), settings_.version);
    task.name = name_of(task.kind, causes);
    for (const std::string& date : task.earlier) task.edits[date] = edits(date);
    if (task.kind != TaskKind::kDate) {
      for (const std::string& date : task.needs) task.edits[date] = edits(date);
    }
    return tasks_.add(std::move(task));
  }

  const FarmSettings& settings_;
  const EditsOf& edits_of_;
  TaskList& tasks_;
  std::vector<std::string> dates_;
  double max_offset_m_ = 0.0;  ///< of all drives up to now
};

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
    BlockTasks of_block(settings, edits_of, tasks);
    for (const auto& [date, drives_of_date] : by_date) of_block.add_date(drives_of_date);
  }
  return tasks.take();
}

}  // namespace orchard::farm
