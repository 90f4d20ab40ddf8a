// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "farm/cost_fit.hpp"
#include "farm/drive_pieces.hpp"
#include "farm/farm_tasks.hpp"
#include "farm/step_lots.hpp"

namespace orchard::farm {
namespace {

Drive drive(const std::string& block, const std::string& date, const std::string& robot,
            const std::string& log_digest) {
  Drive d;
  d.block = block, d.date = date, d.robot = robot, d.name = "drive";
  d.log_paths = {"logs/" + d.title() + ".lcm"};
  d.log_digest = log_digest;
  return d;
}

std::vector<Drive> farm_of(int num_blocks, int num_dates, int num_robots) {
  std::vector<Drive> drives;
  for (int b = 0; b < num_blocks; ++b) {
    for (int d = 0; d < num_dates; ++d) {
      for (int r = 0; r < num_robots; ++r) {
        const std::string log =
            std::to_string(b) + "." + std::to_string(d) + "." + std::to_string(r);
        drives.push_back(drive("block_" + std::to_string(b), "2026-0" + std::to_string(d + 1),
                               "robot_" + std::to_string(r), log));
      }
    }
  }
  return drives;
}

std::set<std::string> names_of(const std::vector<FarmTask>& tasks) {
  std::set<std::string> names;
  for (const FarmTask& task : tasks) names.insert(task.name);
  return names;
}

/// How many tasks of each kind of `now` were not there before.
std::map<TaskKind, int> num_new(const std::vector<FarmTask>& before,
                                const std::vector<FarmTask>& now) {
  const auto known = names_of(before);
  std::map<TaskKind, int> num;
  for (const FarmTask& task : now) num[task.kind] += known.count(task.name) == 0 ? 1 : 0;
  return num;
}

TEST(FarmTasks, AreInOrderAndNeedOnlyWhatStandsBefore) {
  const auto tasks = tasks_of(farm_of(3, 3, 2), {});
  EXPECT_EQ(tasks.size(), 18U + 9U + 6U + 9U) << "maps, dates, changes, reports";
  std::set<std::string> before;
  for (const FarmTask& task : tasks) {
    for (const std::string& need : task.needs) EXPECT_EQ(before.count(need), 1U) << task.name;
    for (const std::string& date : task.earlier) EXPECT_EQ(before.count(date), 1U) << task.name;
    before.insert(task.name);
  }
  EXPECT_EQ(before.size(), tasks.size()) << "each once";
}

TEST(FarmTasks, DoNotDependOnTheOrderInWhichDrivesAreFound) {
  auto drives = farm_of(3, 2, 2);
  const auto tasks = tasks_of(drives, {});
  std::reverse(drives.begin(), drives.end());
  const auto again = tasks_of(drives, {});
  ASSERT_EQ(tasks.size(), again.size());
  for (std::size_t i = 0; i < tasks.size(); ++i) EXPECT_EQ(tasks[i].name, again[i].name);
}

TEST(FarmTasks, OfOneMoreLogAreThoseThatDependOnIt) {
  auto drives = farm_of(3, 3, 2);
  const auto before = tasks_of(drives, {});
  drives.push_back(drive("block_1", "2026-02", "robot_7", "new"));
  auto num = num_new(before, tasks_of(drives, {}));
  EXPECT_EQ(num[TaskKind::kMap], 1);
  EXPECT_EQ(num[TaskKind::kDate], 2) << "its date and the one after";
  EXPECT_EQ(num[TaskKind::kChanges], 2);
}

TEST(FarmTasks, OfAnotherRigAreItsMapsAndWhatFollows) {
  auto drives = farm_of(2, 2, 2);
  const auto before = tasks_of(drives, {});
  for (Drive& d : drives) {
    if (d.robot == "robot_1") d.rig_digest = "mended";
  }
  auto num = num_new(before, tasks_of(drives, {}));
  EXPECT_EQ(num[TaskKind::kMap], 4);
  EXPECT_EQ(num[TaskKind::kDate], 4);
  EXPECT_EQ(num[TaskKind::kChanges], 2);
}

TEST(FarmTasks, OfAnEditedDateAreTheDatesAfterIt) {
  const auto drives = farm_of(2, 3, 2);
  const auto before = tasks_of(drives, {});
  std::vector<std::string> dates;
  for (const FarmTask& task : before) {
    if (task.kind == TaskKind::kDate) dates.push_back(task.name);
  }
  auto num = num_new(before, tasks_of(drives, {}, [&](const std::string& name) {
                       return name == dates[0] ? std::string("a tree felled") : std::string();
                     }));
  EXPECT_EQ(num[TaskKind::kMap], 0);
  EXPECT_EQ(num[TaskKind::kDate], 2) << "the two after it, and none of the other block";
  EXPECT_EQ(num[TaskKind::kChanges], 2);
}

TEST(FarmTasks, OfAnEditedDateAreItsOwnPages) {
  const auto drives = farm_of(1, 2, 1);
  const auto before = tasks_of(drives, {});
  const std::string last = before.back().needs.front();
  auto num = num_new(before, tasks_of(drives, {}, [&](const std::string& name) {
                       return name == last ? std::string("a tree felled") : std::string();
                     }));
  EXPECT_EQ(num[TaskKind::kDate], 0);
  EXPECT_EQ(num[TaskKind::kChanges], 1) << "they are compared as corrected";
  EXPECT_EQ(num[TaskKind::kReport], 1);
}

TEST(FarmTasks, JoinMapsWithinWhatTheirDrivesWarrant) {
  auto drives = farm_of(1, 3, 2);
  for (Drive& d : drives) d.max_offset_m = Drive::kMaxOffsetOfFixes_m;
  const auto offsets = [](const std::vector<FarmTask>& tasks) {
    std::vector<double> all_m;
    for (const FarmTask& task : tasks) {
      if (task.kind == TaskKind::kDate) all_m.push_back(task.max_offset_m);
    }
    return all_m;
  };
  EXPECT_EQ(offsets(tasks_of(drives, {})), (std::vector<double>{0.5, 0.5, 0.5}));
  drives[2].max_offset_m = Drive::kMaxOffset_m;  // of the second date
  EXPECT_EQ(offsets(tasks_of(drives, {})), (std::vector<double>{0.5, 5.0, 5.0}));
  FarmSettings settings;
  settings.max_offset_m = 2.0;
  EXPECT_EQ(offsets(tasks_of(drives, settings)), (std::vector<double>{2.0, 2.0, 2.0}));
}

TEST(FarmTasks, NameTheCorrectionsThatAStepMustFind) {
  const auto tasks = tasks_of(farm_of(1, 3, 1), {}, [](const std::string& name) {
    return name.rfind("date-", 0) == 0 ? "of " + name : std::string();
  });
  for (const FarmTask& task : tasks) {
    std::set<std::string> dates(task.earlier.begin(), task.earlier.end());
    if (task.kind != TaskKind::kDate) dates.insert(task.needs.begin(), task.needs.end());
    ASSERT_EQ(task.edits.size(), dates.size()) << task.name;
    for (const std::string& date : dates) EXPECT_EQ(task.edits.at(date), "of " + date);
  }
}

TEST(FarmTasks, PutEachDateIntoTheDatabaseWhereThereIsOne) {
  const auto drives = farm_of(2, 3, 2);
  FarmSettings settings;
  const auto before = tasks_of(drives, settings);
  settings.publish_to = "service=farm";
  const auto now = tasks_of(drives, settings);
  auto num = num_new(before, now);
  EXPECT_EQ(num[TaskKind::kPublish], 6);
  EXPECT_EQ(now.size(), before.size() + 6U) << "and nothing else has another name";
  settings.publish_to = "service=other";
  num = num_new(now, tasks_of(drives, settings));
  EXPECT_EQ(num[TaskKind::kPublish], 6) << "another database has none of them yet";
  std::string newest;
  for (const FarmTask& task : now) {
    if (task.kind == TaskKind::kDate) newest = task.name;
  }
  settings.publish_to = "service=farm";
  num = num_new(now, tasks_of(drives, settings, [&](const std::string& name) {
                  return name == newest ? std::string("a tree felled") : std::string();
                }));
  EXPECT_EQ(num[TaskKind::kPublish], 1) << "what people corrected goes there, too";
}

TEST(FarmTasks, OfALogThatLiesInTwoPlacesAreMadeOnce) {
  std::vector<Drive> drives{drive("a", "1", "x", "log"), drive("a", "1", "y", "log"),
                            drive("b", "1", "x", "log")};
  const auto tasks = tasks_of(drives, {});
  ASSERT_EQ(tasks.size(), 4U) << "one map, one date: both blocks hold the same, and each has a "
                                 "report of its own name";
  EXPECT_EQ(tasks[0].drives.size(), 3U);
  EXPECT_EQ(tasks[1].needs.size(), 1U);
}

std::string text_of(const std::vector<std::string>& files) {
  std::string text;
  for (const DrivePieces& drive : drives_of_files(files)) {
    text += drive.name + " =";
    for (const std::string& file : drive.files) text += " " + file;
    if (!drive.missing.empty()) text += " without " + drive.missing;
    text += "\n";
  }
  return text;
}

TEST(DrivePieces, OfTheRecorderAreOneDrive) {
  EXPECT_EQ(text_of({"a-001.lcm", "b-000.lcm", "a-000.lcm", "a-002.lcm"}),
            "a = a-000.lcm a-001.lcm a-002.lcm\nb = b-000.lcm\n");
  EXPECT_EQ(text_of({"a-1000.lcm", "a-999.lcm"}), "a = a-999.lcm a-1000.lcm without 0-998\n")
      << "in order of numbers, not of letters";
}

TEST(DrivePieces, ThatAreMissingAreNamed) {
  EXPECT_EQ(text_of({"a-003.lcm", "a-004.lcm", "a-006.lcm", "a-009.lcm"}),
            "a = a-003.lcm a-004.lcm a-006.lcm a-009.lcm without 0-2, 5, 7-8\n");
  EXPECT_EQ(text_of({"a.lcm.00", "a.lcm.02"}), "a = a.lcm.00 a.lcm.02 without 1\n");
}

TEST(DrivePieces, AreNotWhatOnlyLooksLikeThem) {
  EXPECT_EQ(text_of({"north-20260430.lcm", "north-20260501.lcm"}),
            "north-20260430 = north-20260430.lcm\nnorth-20260501 = north-20260501.lcm\n");
  EXPECT_EQ(text_of({"row-7.lcm", "row-8.lcm", "a-007.lcm"}),
            "a-007 = a-007.lcm\nrow-7 = row-7.lcm\nrow-8 = row-8.lcm\n");
  EXPECT_EQ(text_of({"a.lcm", "a-000.lcm"}), "a = a.lcm\na = a-000.lcm\n");
  EXPECT_EQ(text_of({"a.lcm.0", "a.lcm.00", "a.lcm"}), "a = a.lcm a.lcm.0 a.lcm.00\n")
      << "no file is dropped";
  EXPECT_EQ(text_of({"a.txt", ".lcm", "a.lcm.x", "a.lcm.123456789012"}), "");
}

TEST(DrivePieces, OfLcmLoggerAreOneDrive) {
  EXPECT_EQ(text_of({"a.lcm.100", "a.lcm.99", "b.lcm"}),
            "a = a.lcm.99 a.lcm.100 without 0-98\nb = b.lcm\n");
}

// The examples that NIST gives for SHA-256.
TEST(Sha256, GivesTheStandardsDigests) {
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256_hex(std::string(1000000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, DoesNotDependOnThePiecesInWhichBytesCome) {
  std::string text;
  for (int i = 0; i < 1000; ++i) text += static_cast<char>((i * 31) % 251);
  for (const std::size_t piece : {1UL, 3UL, 55UL, 63UL, 64UL, 65UL, 999UL}) {
    Sha256 digest;
    for (std::size_t at = 0; at < text.size(); at += piece) {
      digest.add(text.data() + at, std::min(piece, text.size() - at));
    }
    EXPECT_EQ(digest.hex(), sha256_hex(text)) << piece;
  }
}

TEST(CostFit, FindsWhatAMapCosts) {
  std::vector<CostSample> samples;
  for (int i = 1; i <= 20; ++i) samples.push_back({0.5 + 0.2 * i, 90.0 + 2.0 * i, 1.0 * i});
  const CostFit fit = fit_costs(samples);
  EXPECT_NEAR(fit.time_s.at_least, 0.5, 1e-9);
  EXPECT_NEAR(fit.time_s.per_mb, 0.2, 1e-9);
  EXPECT_NEAR(fit.memory_mb.of(50.0), 190.0, 1e-9);
}

TEST(CostFit, HasNoPartBelowZero) {
  // Longer logs that are cheaper; and a cost that grows from less than nothing.
  const CostFit cheaper = fit_costs({{9.0, 3.0, 1.0}, {5.0, 3.0, 2.0}, {4.0, 3.0, 3.0}});
  EXPECT_EQ(cheaper.time_s.per_mb, 0.0);
  EXPECT_NEAR(cheaper.time_s.at_least, 6.0, 1e-9) << "the mean";
  const CostFit steep = fit_costs({{1.0, 3.0, 2.0}, {9.0, 3.0, 4.0}});
  EXPECT_EQ(steep.time_s.at_least, 0.0);
  EXPECT_NEAR(steep.time_s.per_mb, (1.0 * 2.0 + 9.0 * 4.0) / (2.0 * 2.0 + 4.0 * 4.0), 1e-9);
  EXPECT_NEAR(fit_costs({{1.0, 80.0, 5.0}}).memory_mb.of(5.0), 80.0, 1e-9);
  EXPECT_GT(fit_costs({}).time_s.at_least, 0.0) << "something is asked for before the first map";
}

/// One second for each map, and as much for each other step, whatever the log.
StepCosts second_each() { return {{TaskKind::kMap, {{1.0, 0.0}, {100.0, 0.0}}}}; }

TEST(StepLots, HoldEveryOpenStepOnceAfterThoseThatItNeeds) {
  const std::vector<FarmTask> tasks = tasks_of(farm_of(40, 3, 2), {});
  const auto is_open = [&](const FarmTask& task) { return task.name.back() != '0'; };
  const Lots lots = lots_of(tasks, second_each(), is_open);
  std::set<std::string> made, open;
  for (const FarmTask& task : tasks) (is_open(task) ? open : made).insert(task.name);
  std::map<std::string, const FarmTask*> by_name;
  for (const FarmTask& task : tasks) by_name[task.name] = &task;
  for (const Lot& lot : lots.maps) {
    for (const std::string& step : lot.steps) EXPECT_TRUE(made.insert(step).second);
  }
  const std::set<std::string> before = made;
  for (const Lot& lot : lots.others) {
    std::set<std::string> here = before;  // of the other lots none is waited for
    for (const std::string& step : lot.steps) {
      const FarmTask& task = *by_name.at(step);
      for (const auto* inputs : {&task.needs, &task.earlier}) {
        for (const std::string& input : *inputs) EXPECT_EQ(here.count(input), 1U) << step;
      }
      here.insert(step);
      EXPECT_TRUE(made.insert(step).second);
    }
  }
  EXPECT_EQ(made.size(), tasks.size());
}

TEST(StepLots, BlocksThatShareADateShareALot) {
  std::vector<Drive> drives;  // two blocks whose first two dates are the same drives
  for (const std::string block : {"a", "b"}) {
    drives.push_back(drive(block, "2026-01", "mule", "first"));
    drives.push_back(drive(block, "2026-02", "mule", "second"));
    drives.push_back(drive(block, "2026-03", "mule", "third of " + block));
  }
  StepCosts costs = second_each();
  costs[TaskKind::kMap].time_s.at_least = 1000.0;  // one step is enough for a lot
  const Lots lots = lots_of(tasks_of(drives, {}), costs, [](const FarmTask&) { return true; });
  EXPECT_EQ(lots.maps.size(), 4U);
  EXPECT_EQ(lots.others.size(), 1U);
}

TEST(StepLots, OfTwoJobsAtATimeAreFewWhateverTheStepsAreExpectedToTake) {
  const std::vector<FarmTask> tasks = tasks_of(farm_of(100, 3, 2), {});
  for (const double expected_s : {1.0, 10.0, 100.0}) {
    StepCosts costs = second_each();
    costs[TaskKind::kMap].time_s.at_least = expected_s;
    const Lots lots = lots_of(
        tasks, costs, [](const FarmTask&) { return true; }, 2);
    for (const auto* phase : {&lots.maps, &lots.others}) {
      EXPECT_LE(phase->size(), 16U) << expected_s;
      EXPECT_GE(phase->size(), 8U) << "none so long that the other core has nothing to do";
    }
  }
}

TEST(StepLots, TheEngineTakesATenthAtMostAndALotNoLongerThanToStartAll) {
  for (const int num_blocks : {1, 10, 100, 1000}) {
    const std::vector<FarmTask> tasks = tasks_of(farm_of(num_blocks, 3, 2), {});
    const Lots lots = lots_of(tasks, second_each(), [](const FarmTask&) { return true; });
    for (const auto* phase : {&lots.maps, &lots.others}) {
      double work_s = 0.0;
      for (const Lot& lot : *phase) work_s += lot.time_s;
      const auto num = static_cast<double>(phase->size());
      EXPECT_LE(0.3 * (num - 1.0), 0.1 * work_s) << num_blocks;
      // w/n + 0.3 n is least at 2 sqrt(0.3 w); whole blocks and the last lot are less even
      EXPECT_LE(work_s / num + 0.3 * num, 2.0 * std::sqrt(0.3 * work_s) + 12.0) << num_blocks;
    }
  }
}

}  // namespace
}  // namespace orchard::farm
