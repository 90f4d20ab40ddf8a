// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "system/cli/cli_fixture.hpp"

namespace orchard::cli_test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kMapHeader =
    "id,class,x_m,y_m,n,roc_mean,probability,se_x_m,se_y_m,width_m,row,position\n";

class EvaluateCommand : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    write_file(path("map.csv"), std::string(kMapHeader) +
                                    "1,tree,1.003,2.004,5,0.9,0.99,0.004,0.006,0.09,,\n"
                                    "2,object,4,0,5,0.001,0.01,0.004,0.006,0.17,,\n");
    write_file(path("truth.csv"), "class,x_m,y_m,width_m\ntree,1,2,0.09\nobject,4,0,0.17\n");
  }
  Result evaluate(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"evaluate", path("map.csv"), "--truth", path("truth.csv")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return orchard(arguments);
  }
};

TEST_F(EvaluateCommand, PrintsThePapersTables) {
  const Result result = evaluate();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("ROC_tree_mean  SE_x (mm)  SE_y (mm)"));
  EXPECT_THAT(result.out, ::testing::ContainsRegex("T1 +5 +0.900 +4.00 +6.00 +5.00\n"));
  EXPECT_THAT(result.out, HasSubstr("found 2 of 2"));
}

TEST_F(EvaluateCommand, JsonIsForPrograms) {
  const auto json = nlohmann::json::parse(evaluate({"--json"}).out);
  EXPECT_EQ(json["perfect"], true);
  EXPECT_NEAR(json["objects"][0]["error_m"].get<double>(), 0.005, 1e-9);
}

TEST_F(EvaluateCommand, CheckAsksForAPerfectMap) {
  EXPECT_EQ(evaluate({"--check"}).exit_code, 0);
  EXPECT_EQ(evaluate({"--check", "--gate", "0.004"}).exit_code, 1);  // the tree is 5 mm off
  EXPECT_EQ(evaluate({"--gate", "0.004"}).exit_code, 0);
  write_file(path("truth.csv"), "class,x_m,y_m,width_m\nobject,1,2,0.09\nobject,4,0,0.17\n");
  EXPECT_EQ(evaluate({"--check"}).exit_code, 1);
}

TEST_F(EvaluateCommand, ASimulatedDriveIsMappedPerfectly) {
  ASSERT_EQ(map(log()).exit_code, 0);
  const Result result = orchard({"evaluate", path("map"), "--truth", truth(), "--check"});
  EXPECT_EQ(result.exit_code, 0) << result.out;
}

TEST_F(EvaluateCommand, FilesThatAreNotWhatTheyShouldBe) {
  const Result missing = orchard({"evaluate", path("none.csv"), "--truth", path("truth.csv")});
  EXPECT_EQ(missing.exit_code, 3);
  EXPECT_THAT(missing.err, HasSubstr("none.csv"));
  write_file(path("truth.csv"), "class,x_m,y_m,width_m\ntree,1,two,0.09\n");
  const Result bad = evaluate();
  EXPECT_EQ(bad.exit_code, 3);
  EXPECT_THAT(bad.err, HasSubstr("truth.csv:2"));
  EXPECT_EQ(count_lines(bad.err), 1);
  EXPECT_EQ(orchard({"evaluate", path("map.csv")}).exit_code, 2);
}

}  // namespace
}  // namespace orchard::cli_test
