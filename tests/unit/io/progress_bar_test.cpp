// SPDX-License-Identifier: BSD-3-Clause
#include "io/progress_bar.hpp"

#include <gtest/gtest.h>

namespace orchard::io {
namespace {

TEST(ProgressBar, TimesToWaitAreRoundedUp) {
  EXPECT_EQ(waiting_text(-1.0), "0 s");
  EXPECT_EQ(waiting_text(0.2), "1 s");
  EXPECT_EQ(waiting_text(59.0), "59 s");
  EXPECT_EQ(waiting_text(59.1), "1 min");
  EXPECT_EQ(waiting_text(116.0), "2 min");
  EXPECT_EQ(waiting_text(3600.0), "1 h 0 min");
  EXPECT_EQ(waiting_text(7501.0), "2 h 6 min");
}

}  // namespace
}  // namespace orchard::io
