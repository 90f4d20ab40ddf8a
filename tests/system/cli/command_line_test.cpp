// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "system/cli/cli_fixture.hpp"

namespace orchard::cli_test {
namespace {

using ::testing::HasSubstr;

TEST(CommandLine, HelpIsEnoughToStart) {
  const Result result = orchard({"--help"});
  EXPECT_EQ(result.exit_code, 0);
  for (const char* command :
       {"simulate", "import", "map", "evaluate", "log", "echo", "doctor", "calibrate",
        "Exit codes: 0 success, 1 failed or interrupted, 2 bad command line"}) {
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

TEST(CommandLine, EveryCommandKnowsHelpAndVersion) {
  const std::vector<std::vector<std::string>> commands{{},
                                                       {"map"},
                                                       {"simulate"},
                                                       {"import"},
                                                       {"overlay"},
                                                       {"compare"},
                                                       {"merge"},
                                                       {"echo"},
                                                       {"doctor"},
                                                       {"log"},
                                                       {"log", "info"},
                                                       {"log", "config"},
                                                       {"evaluate"},
                                                       {"evaluate", "trajectory"},
                                                       {"calibrate"},
                                                       {"calibrate", "camera"},
                                                       {"calibrate", "laser-camera"},
                                                       {"calibrate", "trunks"},
                                                       {"calibrate", "probability"},
                                                       {"calibrate", "delay"}};
  for (const std::vector<std::string>& command : commands) {
    std::vector<std::string> help{"help"}, long_help(command), version(command);
    help.insert(help.end(), command.begin(), command.end());
    long_help.push_back("--help");
    version.push_back("-V");
    const Result helped = orchard(help);
    EXPECT_EQ(helped.exit_code, 0) << helped.err;
    EXPECT_EQ(helped.out, orchard(long_help).out);
    // The words of the library that reads the command line stay inside.
    for (const char* inner : {"->", "ENUM", "FLOAT", "UINT", "INT:", "NONNEGATIVE", "POSITIVE",
                              "REQUIRED", "Excludes:", "Needs:", "SUBCOMMAND", " OR {"}) {
      EXPECT_THAT(helped.out, ::testing::Not(HasSubstr(inner)));
    }
    EXPECT_EQ(orchard(version).exit_code, 0);
    EXPECT_THAT(orchard(version).out, HasSubstr("orchard 0."));
  }
  EXPECT_EQ(orchard({"help", "mpa"}).exit_code, 2);
  for (const char* process : {"orchard-sim-driver", "orchard-log-player"}) {
    EXPECT_THAT(run({std::string(ORCHARD_BUILD_DIR "/bin/") + process, "-V"}).out,
                HasSubstr(std::string(process) + " 0."));
  }
}

TEST(CommandLine, TheSimDriverSaysHowLongItTakes) {
  const Result result = run({ORCHARD_BUILD_DIR "/bin/orchard-sim-driver", "--scene", "tubes",
                             "--lcm-url", "memq://", "--speed", "100"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("publishing 18 s of messages at speed 100, which takes 1 s"));
  EXPECT_THAT(result.err, ::testing::Not(HasSubstr("%")));  // no bar where no person watches
}

TEST(CommandLine, AnglesAreInRadians) {
  for (const char* command : {"map", "compare", "merge"}) {
    const std::string help = orchard({"help", command}).out;
    EXPECT_THAT(help, HasSubstr("--max-turn-rad"));
    EXPECT_THAT(help, ::testing::Not(HasSubstr("[degrees]")));
  }
  // The name of the last release still works and names the new one.
  const Result old = orchard({"compare", "a", "b", "--max-turn", "10"});
  EXPECT_EQ(old.exit_code, 3);
  EXPECT_THAT(old.err, HasSubstr("--max-turn-rad"));
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
  const Result result = orchard({"map", "x.lcm"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--out"));
}

TEST(CommandLine, UnknownSceneIsABadCommandLine) {
  const Result result = orchard({"simulate", "--scene", "moon", "--out", "/nonexistent/x"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("tubes"));
}

}  // namespace
}  // namespace orchard::cli_test
