// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "system/album/album_run.hpp"

namespace orchard::test {
namespace {

io::Config orchard_rig() {
  return io::load_config(std::string(ORCHARD_SOURCE_DIR) + "/config/orchard.yaml");
}

TEST(Album, NearlyEveryTreeHasAPhotographWithItsTrunkInTheMiddle) {
  const AlbumOutcome outcome = run_album(orchard_rig(), 1, "");
  EXPECT_GE(outcome.num_trees, 40);
  EXPECT_GE(outcome.num_centred, 0.99 * outcome.num_trees);
  EXPECT_EQ(outcome.num_same, outcome.num_photographed) << "cut out of the picture it names";
  EXPECT_LE(outcome.num_bytes, 8'000'000u);
}

TEST(Album, ItsBytesAreBoundedAsConfiguredAndNoneAreKeptAtZero) {
  io::Config config = orchard_rig();
  config.simulation.orchard.num_rows = 2;
  config.simulation.orchard.trees_per_row = 6;
  config.mapper.album.max_mb = 0.03;
  const AlbumOutcome few = run_album(config, 2, "");
  EXPECT_LE(few.num_bytes, 30'000u);
  EXPECT_GE(few.num_photographed, 3) << few.num_trees << " trees, " << few.num_bytes << " bytes";
  EXPECT_LT(few.num_photographed, few.num_trees);
  config.mapper.album.max_mb = 0.0;
  EXPECT_EQ(run_album(config, 2, "").num_bytes, 0u);
}

}  // namespace
}  // namespace orchard::test
