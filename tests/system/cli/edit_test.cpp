// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <pwd.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <thread>

#include "system/cli/cli_fixture.hpp"

namespace orchard::cli_test {
namespace {

using ::testing::HasSubstr;

/// Forty trees in four rows, planted a little irregularly and of different widths; without the
/// one at `without`, moved by `offset_m`.
std::string forty_trees(int without, double offset_m, double scale = 1.0) {
  std::string text = kMapHeader;
  for (int i = 0; i < 40; ++i) {
    if (i == without) continue;
    const double x = 2.0 * (i % 10) + 0.1 * ((i * 7) % 5 - 2) + offset_m;
    const double y = 4.0 * (i / 10) + 0.1 * ((i * 11) % 7 - 3);
    text += std::to_string(i + 1) + ",tree," + std::to_string(scale * x) + "," +
            std::to_string(scale * y) + ",9,0.9,0.99,0.005,0.005," +
            std::to_string(scale * (0.1 + 0.005 * ((i * 13) % 9))) + ",,\n";
  }
  return text;
}

class CompareCommand : public CliTest {
 protected:
  std::string map_csv(const std::string& name, const std::string& text) const {
    write_file(path(name), text);
    return path(name);
  }
};

TEST_F(CompareCommand, TellsWhatIsGone) {
  const std::string a = map_csv("a.csv", forty_trees(-1, 0.0));
  const std::string b = map_csv("b.csv", forty_trees(17, 1.3));
  const Result blind = orchard({"compare", a, b});
  EXPECT_EQ(blind.exit_code, 3);
  EXPECT_THAT(blind.err, HasSubstr("--assume-seen"));
  const Result result =
      orchard({"compare", a, b, "--assume-seen", "--json", "--out", path("changes")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["counts"]["missing"], 1);
  EXPECT_EQ(json["counts"]["unchanged"], 39);
  EXPECT_NEAR(json["alignment"]["x_m"].get<double>(), -1.3, 0.01);
  for (const char* file : {"compare.csv", "compare.gpkg", "compare.svg", "compare.png"}) {
    EXPECT_TRUE(exists(path("changes/") + file)) << file;
  }
  EXPECT_THAT(read_file(path("changes/compare.csv")), HasSubstr("missing,"));
  const std::string first = read_file(path("changes/compare.gpkg"));
  ASSERT_EQ(orchard({"compare", a, b, "--assume-seen", "--out", path("changes")}).exit_code, 0);
  EXPECT_TRUE(read_file(path("changes/compare.gpkg")) == first) << "the same bytes";
}

TEST_F(CompareCommand, RefusesMapsThatAreNone) {
  const std::string a = map_csv("a.csv", forty_trees(-1, 0.0));
  const std::string mm = map_csv("mm.csv", forty_trees(-1, 0.0, 1000.0));
  const Result units = orchard({"compare", a, mm, "--assume-seen"});
  EXPECT_EQ(units.exit_code, 3);
  EXPECT_THAT(units.err, HasSubstr("mm.csv:2: width_m"));
  const std::string empty = map_csv("empty.csv", kMapHeader);
  EXPECT_EQ(orchard({"compare", a, empty, "--assume-seen"}).exit_code, 3);
  EXPECT_EQ(orchard({"compare", a, path("none.csv"), "--assume-seen"}).exit_code, 3);
  const std::string far = map_csv("far.csv", forty_trees(-1, 500.0));
  const Result apart = orchard({"compare", a, far, "--assume-seen"});
  EXPECT_EQ(apart.exit_code, 3);
  EXPECT_THAT(apart.err, HasSubstr("cannot be aligned with"));
  EXPECT_EQ(orchard({"compare", a, far, "--assume-seen", "--any-place"}).exit_code, 0);
}

TEST_F(CompareCommand, MergesAMapThatTouchesOnlyALaterOne) {
  const std::string trees = forty_trees(-1, 0.0);
  std::vector<std::string> lines{""};
  for (const char c : trees) {
    lines.back() += c;
    if (c == '\n') lines.emplace_back();
  }
  // rows 1 and 2, rows 3 and 4, rows 2 and 3
  const auto part = [&](const std::string& name, int first, int last) {
    std::string text = kMapHeader;
    for (int i = first; i <= last; ++i) text += lines[static_cast<std::size_t>(i)];
    return map_csv(name, text);
  };
  const std::string a = part("a.csv", 1, 20), c = part("c.csv", 21, 40), b = part("b.csv", 11, 30);
  const Result apart = orchard({"merge", a, c, "--max-offset", "1", "--out", path("apart")});
  EXPECT_EQ(apart.exit_code, 3) << apart.out;
  const Result result = orchard({"merge", a, c, b, "--max-offset", "1", "--out", path("all")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(count_lines(read_file(path("all/map.csv"))), 41) << "every tree once";
  const std::string ids = read_file(path("all/ids.csv"));
  EXPECT_LT(ids.find("\n2,21,"), ids.find("\n3,11,")) << "in order of the maps given";
}

TEST_F(CompareCommand, MergesAndNeverOverwritesAnInput) {
  ASSERT_EQ(orchard({"merge", map_csv("a.csv", forty_trees(3, 0.0)),
                     map_csv("b.csv", forty_trees(20, 0.7)), "--out", path("both")})
                .exit_code,
            0);
  const std::string merged = read_file(path("both/map.csv"));
  EXPECT_EQ(count_lines(merged), 41) << "every tree once";
  EXPECT_THAT(read_file(path("both/ids.csv")), HasSubstr("\n2,4,41\n")) << "a new id for tree 4";
  const Result again = orchard({"merge", path("both"), path("a.csv"), "--out", path("both")});
  EXPECT_EQ(again.exit_code, 3);
  EXPECT_THAT(again.err, HasSubstr("must not be overwritten"));
  EXPECT_EQ(read_file(path("both/map.csv")), merged);
  const Result apart = orchard(
      {"merge", path("both"), map_csv("far.csv", forty_trees(-1, 500.0)), "--out", path("third")});
  EXPECT_EQ(apart.exit_code, 3);
  EXPECT_FALSE(exists(path("third/map.csv")));
}

TEST_F(CompareCommand, LeavesOutWhatIsOfAnotherOrchardAndKeepsIds) {
  // The earlier map counted from 1 on; of the later ones the first numbers its trees otherwise.
  const std::string april = map_csv("april.csv", forty_trees(-1, 0.0));
  std::string shuffled = kMapHeader;
  std::istringstream lines(forty_trees(3, 0.2));
  std::string line;
  std::getline(lines, line);
  for (int id = 101; std::getline(lines, line); ++id) {
    shuffled += std::to_string(id) + line.substr(line.find(',')) + "\n";
  }
  const std::string may_1 = map_csv("may_1.csv", shuffled);
  const std::string may_2 = map_csv("may_2.csv", forty_trees(20, 0.0));
  const std::string other = map_csv("other.csv", forty_trees(-1, 500.0));
  const Result may = orchard(
      {"merge", other, may_1, may_2, "--previous", april, "--leave-out", "--out", path("may")});
  ASSERT_EQ(may.exit_code, 0) << may.err;
  EXPECT_THAT(may.out, HasSubstr("40 kept, 0 gone, 0 new"));
  const std::string left_out = read_file(path("may/left_out.csv"));
  EXPECT_EQ(count_lines(left_out), 2) << left_out;
  EXPECT_THAT(left_out, HasSubstr("other.csv\",\""));
  const std::string ids = read_file(path("may/ids.csv"));
  EXPECT_THAT(ids, HasSubstr("\n2,101,1\n")) << "the first tree, as the earlier map called it";
  EXPECT_THAT(ids, HasSubstr("\n3,4,4\n")) << "which the first robot had not seen";
  EXPECT_THAT(ids, ::testing::Not(HasSubstr("\n1,"))) << ids;

  // None fits the earlier map: all ids are new, and why is told. A later date carries on the ids of
  // the latest date that it fits.
  const Result alone =
      orchard({"merge", other, "--previous", april, "--leave-out", "--out", path("alone")});
  ASSERT_EQ(alone.exit_code, 0) << alone.err;
  EXPECT_THAT(alone.err, HasSubstr("so all ids are new"));
  EXPECT_THAT(read_file(path("alone/ids.csv")), HasSubstr("\n1,1,42\n")) << "41 is free in april";
  EXPECT_THAT(read_file(path("alone/left_out.csv")), HasSubstr("april.csv\",\""));
  const Result june = orchard({"merge", may_1, may_2, "--previous", path("alone"), "--previous",
                               april, "--leave-out", "--out", path("june")});
  ASSERT_EQ(june.exit_code, 0) << june.err;
  EXPECT_THAT(june.out, HasSubstr("april.csv: 40 kept, 0 gone, 0 new"));
  const std::string refused = read_file(path("june/left_out.csv"));
  EXPECT_THAT(refused, HasSubstr("alone\",\""));
  EXPECT_THAT(refused, ::testing::Not(HasSubstr("april.csv\",\"")));
  const Result misfits = orchard({"merge", other, map_csv("third.csv", forty_trees(-1, 900.0)),
                                  "--previous", april, "--leave-out", "--out", path("misfits")});
  EXPECT_EQ(misfits.exit_code, 3);
  EXPECT_THAT(misfits.err, HasSubstr("it is unknown which"));

  // One against one: nobody can tell which is of the orchard.
  const Result two = orchard({"merge", other, may_1, "--leave-out", "--out", path("two")});
  EXPECT_EQ(two.exit_code, 3);
  EXPECT_THAT(two.err, HasSubstr("it is unknown which"));
  EXPECT_FALSE(exists(path("two/map.csv")));
  const Result three =
      orchard({"merge", other, may_1, may_2, "--leave-out", "--out", path("three")});
  ASSERT_EQ(three.exit_code, 0) << three.err;
  EXPECT_THAT(read_file(path("three/left_out.csv")), HasSubstr("other.csv"));
}

using ::testing::Not;
using Json = nlohmann::json;

/// Four rows of ten trees, 2 m and 4 m apart; number 14 (row 2 tree 4) was missed.
std::string numbered_trees(int missed = 14) {
  std::string text = kMapHeader;
  for (int i = 0; i < 40; ++i) {
    if (i + 1 == missed) continue;
    text += std::to_string(i + 1) + ",tree," + std::to_string(2.0 * (i % 10) + 0.01 * (i * 7 % 5)) +
            "," + std::to_string(4.0 * (i / 10) + 0.01 * (i * 11 % 7)) +
            ",9,0.9,0.99,0.005,0.005," + std::to_string(0.1 + 0.005 * (i * 13 % 9)) + "," +
            std::to_string(i / 10 + 1) + "," + std::to_string(i % 10 + 1) + "\n";
  }
  return text;
}

class EditCommand : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    map_ = path("map");
    run({"mkdir", map_});
    write_file(map_ + "/map.csv", numbered_trees());
  }
  Result edit(std::vector<std::string> words) const {
    words.insert(words.begin() + 1, map_);
    words.insert(words.begin(), "edit");
    return orchard(words);
  }
  Json list() const { return Json::parse(edit({"list", "--json"}).out); }
  std::string corrected() const {
    EXPECT_EQ(edit({"apply", "--out", path("corrected")}).exit_code, 0);
    return read_file(path("corrected/map.csv"));
  }

  std::string map_;
};

TEST_F(EditCommand, LeavesTheMapAndWritesACorrectedOne) {
  const std::string before = read_file(map_ + "/map.csv");
  ASSERT_EQ(edit({"delete", "1/1", "--who", "Ana", "--note", "a shadow"}).exit_code, 0);
  const Result add = edit({"add", "2/4", "--width", "0.12"});
  ASSERT_EQ(add.exit_code, 0) << add.err;
  EXPECT_THAT(add.out, HasSubstr("41 (tree, row 2 tree 4)"));
  ASSERT_EQ(edit({"class", "5", "object"}).exit_code, 0);
  ASSERT_EQ(edit({"row", "2", "by the road"}).exit_code, 0);
  ASSERT_EQ(edit({"note", "by the road/4", "planted again"}).exit_code, 0) << "row by its name";
  ASSERT_EQ(edit({"undo", "3"}).exit_code, 0);
  EXPECT_EQ(list()[0]["who"], "Ana");
  EXPECT_EQ(list()[1]["who"], ::getpwuid(::geteuid())->pw_name) << "whose account it is";
  EXPECT_TRUE(read_file(map_ + "/map.csv") == before);
  const std::string after = corrected();
  EXPECT_THAT(after, Not(HasSubstr("\n1,tree,")));
  EXPECT_THAT(after, HasSubstr("\n41,tree,6."));
  EXPECT_THAT(after, HasSubstr("0.1200,2,4,"));
  EXPECT_THAT(after, HasSubstr("\n5,tree,"));
  const Json json = list();
  ASSERT_EQ(json.size(), 6u);
  EXPECT_EQ(json[0]["who"], "Ana");
  EXPECT_EQ(json[0]["note"], "a shadow");
  EXPECT_EQ(json[2]["outcome"], "undone");
  EXPECT_EQ(json[4]["landmarks"][0]["id"], 41);
  EXPECT_EQ(edit({"check"}).exit_code, 0);
}

TEST_F(EditCommand, RefusesWhatContradictsTheMap) {
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"delete", "999"},
                                             {"delete", "9/1"},
                                             {"add", "1/1"},
                                             {"add", "--at", "0.05", "0"},
                                             {"add"},
                                             {"row", "9", "far"},
                                             {"renumber", "3", "--row", "1", "--position", "4"},
                                             {"note", "3", "two\nlines"},
                                             {"undo"},
                                             {"redo"},
                                             {"undo", "4"}}) {
    const Result result = edit(words);
    EXPECT_EQ(result.exit_code, 3) << words[0] << " " << (words.size() > 1 ? words[1] : "");
    EXPECT_EQ(count_lines(result.err), 1) << result.err;
    EXPECT_FALSE(exists(map_ + "/corrections.jsonl")) << "nothing is written";
  }
  const Result misspelt = edit({"delte", "3"});
  EXPECT_EQ(misspelt.exit_code, 2);
  EXPECT_THAT(misspelt.err, HasSubstr("did you mean delete?"));
  EXPECT_EQ(orchard({"edit", "delete", map_ + "/map.csv", "3"}).exit_code, 3);
}

TEST_F(EditCommand, TwoEditorsAtOnceLoseNothing) {
  constexpr int kEach = 25;
  std::vector<std::string> failures[2];
  const auto work = [&](int editor) {
    for (int i = 0; i < kEach; ++i) {
      const std::string id = std::to_string(1 + (7 * i + 3 * editor) % 13);
      const Result result =
          edit({"note", id, "words " + std::to_string(i), "--who", editor == 0 ? "Ana" : "Ben"});
      if (result.exit_code != 0) failures[editor].push_back(result.err);
    }
  };
  std::thread other(work, 1);
  work(0);
  other.join();
  EXPECT_TRUE(failures[0].empty() && failures[1].empty());
  const Json json = list();
  ASSERT_EQ(json.size(), 2u * kEach);
  std::set<std::string> said;
  for (std::size_t i = 0; i < json.size(); ++i) {
    EXPECT_EQ(json[i]["n"], i + 1);
    said.insert(json[i]["who"].get<std::string>() + json[i]["note"].get<std::string>());
  }
  EXPECT_EQ(said.size(), 2u * kEach);
}

TEST_F(EditCommand, SaysWhatIsDamaged) {
  ASSERT_EQ(edit({"delete", "3"}).exit_code, 0);
  const std::string file = map_ + "/corrections.jsonl";
  const std::string whole = read_file(file);
  write_file(file, whole + whole.substr(0, 40));  // killed while it wrote
  EXPECT_EQ(list().size(), 1u);
  EXPECT_EQ(edit({"check"}).exit_code, 3);
  const Result next = edit({"delete", "4"});
  EXPECT_EQ(next.exit_code, 0);
  EXPECT_THAT(next.err, HasSubstr("40 bytes are ignored"));
  EXPECT_EQ(list().size(), 2u);
  write_file(file, whole + "{\"n\":2,\"when\":\"yesterday\"}\n");
  const Result bad = edit({"list"});
  EXPECT_EQ(bad.exit_code, 3);
  EXPECT_THAT(bad.err, HasSubstr("corrections.jsonl:2: `when` must be a time like"));
  for (const char* line : {"[]", "{", "{\"n\":1}", "\xFF", "null",
                           "{\"n\":2,\"when\":\"2026-05-04T08:00:00Z\",\"who\":\"A\",\"what\":"
                           "\"delete\",\"landmarks\":[{\"id\":3,\"x_m\":1e999,\"y_m\":0,"
                           "\"class\":\"tree\"}]}"}) {
    write_file(file, whole + line + "\n");
    EXPECT_EQ(edit({"list"}).exit_code, 3) << line;
  }
}

TEST_F(EditCommand, IsCarriedToTheNextMap) {
  const std::string a = path("a"), b = path("b");
  const std::string drive = path("drive.lcm");
  ASSERT_EQ(
      orchard({"simulate", "--scene", "orchard", "--seed", "7", "--duration", "20", "--out", drive})
          .exit_code,
      0);
  ASSERT_EQ(orchard({"map", drive, "--out", a, "--quiet"}).exit_code, 0);
  const auto at_a = [&](std::vector<std::string> words) {
    words.insert(words.begin() + 1, a);
    words.insert(words.begin(), "edit");
    return orchard(words).exit_code;
  };
  ASSERT_EQ(at_a({"delete", "2"}), 0);
  ASSERT_EQ(at_a({"class", "3", "object"}), 0);
  ASSERT_EQ(at_a({"note", "4", "grafted"}), 0);
  const std::string plain = read_file(a + "/map.csv");
  const Result result = orchard({"map", drive, "--previous", a, "--out", b});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("corrections by hand: 3 applied"));
  EXPECT_TRUE(read_file(b + "/map.csv") == plain) << "the run's map stays its own";
  EXPECT_EQ(Json::parse(read_file(b + "/summary.json"))["counts"]["corrections_applied"], 3);
  EXPECT_TRUE(read_file(b + "/corrections.jsonl") == read_file(a + "/corrections.jsonl"));
  // Once more into the same folder: nothing of anybody would be lost, until somebody edits there.
  EXPECT_EQ(orchard({"map", drive, "--previous", a, "--out", b, "--quiet"}).exit_code, 0);
  ASSERT_EQ(orchard({"edit", "delete", b, "5"}).exit_code, 0);
  const Result refused = orchard({"map", drive, "--previous", a, "--out", b});
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.err, HasSubstr("has correction 4"));
}

TEST_F(EditCommand, ComparisonKnowsWhatPeopleSaid) {
  run({"mkdir", path("later")});
  write_file(path("later/map.csv"), numbered_trees(0));
  const std::vector<std::string> compare{"compare",       map_,     path("later"),
                                         "--assume-seen", "--json", "--any-place"};
  const auto changes = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = compare;
    words.insert(words.end(), more.begin(), more.end());
    const Result result = orchard(words);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out)["counts"];
  };
  EXPECT_EQ(changes({})["new"], 1);  // number 14 was missed
  ASSERT_EQ(edit({"add", "2/4"}).exit_code, 0);
  EXPECT_EQ(changes({})["new"], 0);
  EXPECT_EQ(changes({})["grown"], 0);  // its width is not known, and so has not changed
  EXPECT_EQ(changes({"--as-mapped"})["new"], 1);
  ASSERT_EQ(orchard({"edit", "delete", path("later"), "14"}).exit_code, 0);
  EXPECT_EQ(changes({})["missing"], 1);  // what a person added, another one deleted
}

}  // namespace

}  // namespace orchard::cli_test
