// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/finish/findings.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "../rows/planted_rows.hpp"
#include "mapping/rows/rows.hpp"

namespace orchard::mapping {
namespace {

std::vector<std::string> names_of(const std::vector<Finding>& findings) {
  std::vector<std::string> names;
  for (const Finding& finding : findings) names.push_back(finding.name);
  return names;
}

std::vector<Landmark> numbered_block(int seed) {
  std::mt19937_64 random(seed);
  std::vector<Landmark> landmarks = test::plant({}, random).landmarks;
  for (Landmark& l : landmarks) l.width_m = 0.12;
  number_landmarks(find_rows(landmarks, {}), landmarks);
  return landmarks;
}

TEST(MapFindings, ABlockInRowsIsNotDoubtful) {
  for (int seed = 1; seed <= 20; ++seed) {
    EXPECT_EQ(names_of(findings_of(numbered_block(seed), true)), std::vector<std::string>{});
  }
}

TEST(MapFindings, TreesThatStandInOneAnotherAreCounted) {
  std::vector<Landmark> landmarks = numbered_block(1);
  Landmark twin = landmarks.front();
  twin.id = 9999;
  twin.label = detection::Label::kTree;
  landmarks.front().label = detection::Label::kTree;
  twin.x_m += 0.11;
  landmarks.push_back(twin);
  ASSERT_EQ(names_of(findings_of(landmarks, true)), std::vector<std::string>{"overlapping_trees"});
  EXPECT_EQ(findings_of(landmarks, true).front().text.substr(0, 8), "2 trees ");
  landmarks.back().x_m += 0.02;
  EXPECT_EQ(names_of(findings_of(landmarks, true)), std::vector<std::string>{});
}

TEST(MapFindings, ManyTreesWithoutARow) {
  std::vector<Landmark> landmarks = numbered_block(1);
  for (Landmark& l : landmarks) l.row = l.position = 0;
  EXPECT_EQ(names_of(findings_of(landmarks, true)), std::vector<std::string>{"no_rows"});
  EXPECT_EQ(names_of(findings_of(landmarks, false)), std::vector<std::string>{});
}

TEST(MapFindings, HardlyATreeAmongManyLandmarks) {
  std::vector<Landmark> landmarks = numbered_block(1);
  for (Landmark& l : landmarks) {
    l.label = detection::Label::kObject;
    l.row = l.position = 0;
    l.width_m = 0.31;
  }
  const std::vector<Finding> findings = findings_of(landmarks, true);
  ASSERT_EQ(names_of(findings), std::vector<std::string>{"few_trees"});
  EXPECT_NE(findings.front().text.find("at least 31 cm wide: set detector.width.mean_m"),
            std::string::npos);
  landmarks.resize(29);
  EXPECT_EQ(names_of(findings_of(landmarks, true)), std::vector<std::string>{});
}

}  // namespace
}  // namespace orchard::mapping
