// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "system/cli/cli_fixture.hpp"

namespace orchard::cli_test {
namespace {

using ::testing::HasSubstr;

TEST(CommandLine, HelpIsEnoughToStart) {
  const Result result = orchard({"--help"});
  EXPECT_EQ(result.exit_code, 0);
  for (const char* command : {"simulate", "import", "map", "evaluate", "log", "echo", "doctor",
                              "calibrate", "Exit codes: 0 done, 1 failed, 2 bad command line"}) {
    EXPECT_THAT(result.out, HasSubstr(command));
  }
}

TEST(CommandLine, EveryCommandShowsExamples) {
  const std::vector<std::vector<std::string>> commands{
      {"simulate"},           {"import"},       {"map"},  {"evaluate"}, {"log"},
      {"log", "info"},        {"log", "check"}, {"echo"}, {"doctor"},   {"log", "repair"},
      {"calibrate", "trunks"}};
  for (std::vector<std::string> command : commands) {
    std::string words = "orchard";
    for (const std::string& word : command) words += " " + word;
    command.push_back("--help");
    const Result result = orchard(command);
    EXPECT_EQ(result.exit_code, 0) << words;
    EXPECT_THAT(result.out, HasSubstr("Example")) << words;
    EXPECT_THAT(result.out, HasSubstr(words)) << words;
  }
}

TEST(CommandLine, VersionIsPrinted) {
  const Result result = orchard({"--version"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, HasSubstr("orchard 0."));
}

TEST(CommandLine, MisspeltWordsGetASuggestion) {
  EXPECT_EQ(orchard({"mpa"}).exit_code, 2);
  EXPECT_THAT(orchard({"mpa"}).err, HasSubstr("did you mean map?"));
  EXPECT_THAT(orchard({"evalaute", "x"}).err, HasSubstr("did you mean evaluate?"));
  EXPECT_THAT(orchard({"log", "inof", "x"}).err, HasSubstr("did you mean info?"));
  const Result option = orchard({"map", "x.lcm", "--confg", "y.yaml", "--out", "z"});
  EXPECT_EQ(option.exit_code, 2);
  EXPECT_THAT(option.err, HasSubstr("did you mean --config?"));
}

TEST(CommandLine, FarFetchedWordsGetNone) {
  const Result result = orchard({"xylophone"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, ::testing::Not(HasSubstr("did you mean")));
}

TEST(CommandLine, WhatIsMissingIsNamed) {
  EXPECT_EQ(orchard({}).exit_code, 2);
  EXPECT_EQ(orchard({"log"}).exit_code, 2);
  const Result result = orchard({"map", "x.lcm", "--out", "y"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--config"));
}

TEST(CommandLine, UnknownSceneIsABadCommandLine) {
  const Result result = orchard({"simulate", "--scene", "moon", "--out", "/nonexistent/x"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("tubes"));
}

}  // namespace
}  // namespace orchard::cli_test
