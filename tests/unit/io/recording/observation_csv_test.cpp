// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/observation_csv.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file_error.hpp"
#include "unit/io/test_folder.hpp"

namespace orchard::io {
namespace {

using simulation::TrueObservation;
using ::testing::HasSubstr;

const std::string kHeader =
    "utime_us,object,class,x_m,y_m,width_m,range_m,bearing_rad,num_beams,hidden_fraction,"
    "in_picture\n";

TEST(ObservationCsv, ReadsWhatItWrites) {
  TrueObservation tree;
  tree.utime = 1385942400100000;
  tree.object = 7;
  tree.x_m = -1.25;
  tree.y_m = 12.5;
  tree.width_m = 0.125;
  tree.range_m = 3.5;
  tree.bearing_rad = -0.25;
  tree.num_beams = 9;
  tree.hidden_fraction = 0.375;
  tree.in_picture = true;
  TrueObservation crate = tree;
  crate.object = 30;
  crate.label = detection::Label::kObject;
  crate.in_picture = false;
  TestFolder folder;
  write_observation_csv(folder / "o.csv", {tree, crate});
  const auto read = read_observation_csv(folder / "o.csv");
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].utime, tree.utime);
  EXPECT_EQ(read[0].object, 7);
  EXPECT_EQ(read[0].label, detection::Label::kTree);
  EXPECT_EQ(read[0].x_m, tree.x_m);
  EXPECT_EQ(read[0].y_m, tree.y_m);
  EXPECT_EQ(read[0].width_m, tree.width_m);
  EXPECT_EQ(read[0].range_m, tree.range_m);
  EXPECT_EQ(read[0].bearing_rad, tree.bearing_rad);
  EXPECT_EQ(read[0].num_beams, 9);
  EXPECT_EQ(read[0].hidden_fraction, tree.hidden_fraction);
  EXPECT_TRUE(read[0].in_picture);
  EXPECT_EQ(read[1].label, detection::Label::kObject);
  EXPECT_FALSE(read[1].in_picture);
  EXPECT_THAT(
      read_bytes(folder / "o.csv"),
      HasSubstr("\n1385942400100000,7,tree,-1.2500,12.5000,0.1250,3.5000,-0.25000,9,0.375,1\n"));
}

TEST(ObservationCsv, RefusesWhatCannotBeAndSaysWhere) {
  const std::string good = "100,0,tree,1,2,0.1,3,0.5,4,0.25,1\n";
  EXPECT_EQ(parse_observation_csv(kHeader + good, "a").size(), 1u);
  const struct {
    std::string row, message;
  } cases[] = {
      {"99,1,tree,1,2,0.1,3,0.5,4,0.25,1\n", "a.csv:3:1: "},      // back in time
      {"100,0,tree,1,2,0.1,3,0.5,4,0.25,1\n", "twice"},           // in one scan
      {"200,0,object,1,2,0.1,3,0.5,4,0.25,1\n", "class"},         // changes its class
      {"200,-1,tree,1,2,0.1,3,0.5,4,0.25,1\n", "a.csv:3:5: "},    // no object
      {"200,1,bush,1,2,0.1,3,0.5,4,0.25,1\n", "tree or object"},  // no class
      {"200,1,tree,nan,2,0.1,3,0.5,4,0.25,1\n", "a.csv:3:"},      // no number
      {"200,1,tree,1,2,-0.1,3,0.5,4,0.25,1\n", "a.csv:3:"},       // width
      {"200,1,tree,1,2,0.1,3,50,4,0.25,1\n", "a.csv:3:"},         // bearing in degrees
      {"200,1,tree,1,2,0.1,3,0.5,4.5,0.25,1\n", "a.csv:3:"},      // half a beam
      {"200,1,tree,1,2,0.1,3,0.5,4,1.25,1\n", "a.csv:3:"},        // more than all of it
      {"200,1,tree,1,2,0.1,3,0.5,4,0.25,2\n", "a.csv:3:"},        // neither
      {"200,1,tree,1,2,0.1,3,0.5,4,0.25\n", "a.csv:3"},           // a field less
  };
  for (const auto& c : cases) {
    try {
      parse_observation_csv(kHeader + good + c.row, "a.csv");
      ADD_FAILURE() << c.row;
    } catch (const FileError& error) {
      EXPECT_THAT(error.what(), HasSubstr(c.message)) << c.row;
      EXPECT_THAT(error.what(), HasSubstr("a.csv:3")) << c.row;
    }
  }
  EXPECT_THROW(parse_observation_csv("utime_us,object\n1,2\n", "a.csv"), FileError);
  EXPECT_THROW(read_observation_csv("/no/such/file.csv"), FileError);
}

}  // namespace
}  // namespace orchard::io
