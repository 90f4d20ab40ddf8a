// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "system/cli/cli_fixture.hpp"

namespace orchard::cli_test {
namespace {

using ::testing::HasSubstr;

const char kHeader[] =
    "id,class,x_m,y_m,n,roc_mean,probability,se_x_m,se_y_m,width_m,row,position\n";

/// Forty trees in four rows, planted a little irregularly and of different widths; without the
/// one at `without`, moved by `offset_m`.
std::string forty_trees(int without, double offset_m, double scale = 1.0) {
  std::string text = kHeader;
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
  const std::string empty = map_csv("empty.csv", kHeader);
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
    std::string text = kHeader;
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
  std::string shuffled = kHeader;
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

}  // namespace
}  // namespace orchard::cli_test
