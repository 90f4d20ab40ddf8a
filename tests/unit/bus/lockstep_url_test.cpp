// SPDX-License-Identifier: BSD-3-Clause
#include "bus/replay/lockstep_url.hpp"

#include <gtest/gtest.h>

namespace orchard::bus {
namespace {

TEST(LockstepUrl, IsTheSameNetworkOnAPortOfItsOwn) {
  EXPECT_EQ(lockstep_url("udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304"),
            "udpm://239.255.76.67:17667?ttl=0&recv_buf_size=4194304");
  EXPECT_EQ(lockstep_url("udpm://239.255.76.67:60000"), "udpm://239.255.76.67:50000");
  EXPECT_EQ(lockstep_url("udpm://"), "udpm://239.255.76.67:17667");
  EXPECT_EQ(lockstep_url("udpm://:7700?ttl=1"), "udpm://239.255.76.67:17700?ttl=1");
  EXPECT_EQ(lockstep_url("udpm://239.1.2.3"), "udpm://239.1.2.3:17667");
  EXPECT_EQ(lockstep_url("memq://"), "memq://");
}

}  // namespace
}  // namespace orchard::bus
