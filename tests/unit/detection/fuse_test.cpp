// SPDX-License-Identifier: BSD-3-Clause
#include "detection/fuse.hpp"

#include <gtest/gtest.h>

namespace orchard::detection {
namespace {

TEST(Fuse, GivesThePapersOutdoorAverages) {
  EXPECT_NEAR(fuse_vision(0.9, 0.705, 0.6), 0.822, 1e-12);  // section 6.2
}

TEST(Fuse, ExplainsThePapersObjectB2) {
  // Table 2: 0.461 with colour failed, so that its roc_laser was 0.922.
  EXPECT_NEAR(fuse_tree(0.922, 0.0, 0.5), 0.461, 1e-12);
  EXPECT_EQ(label_of(0.461, 0.6), Label::kObject);
  EXPECT_EQ(label_of(0.786, 0.6), Label::kTree);  // T11, the least of table 1
}

TEST(Fuse, EdgesAreTheMeanOfThree) {
  EXPECT_NEAR(fuse_edges(0.9, 0.6, 0.3), 0.6, 1e-12);
  EXPECT_DOUBLE_EQ(fuse_edges(1.0, 1.0, 1.0), 1.0);
}

TEST(Fuse, TheThresholdItselfIsATree) { EXPECT_EQ(label_of(0.6, 0.6), Label::kTree); }

}  // namespace
}  // namespace orchard::detection
