// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/thicket.hpp"

#include "mapping/landmark_pairing.hpp"

namespace orchard::mapping {
namespace {

constexpr double kStake_m = 0.045;  ///< thinner things stand beside trees as they please
constexpr int kFewestOthers = 2;
constexpr double kNear_m = 0.5;

}  // namespace

std::vector<char> in_thickets(const std::vector<Landmark>& landmarks) {
  std::vector<Eigen::Vector2d> places;
  for (const Landmark& l : landmarks) {
    if (l.width_m > kStake_m) places.push_back({l.x_m, l.y_m});
  }
  const IndexedPoints things(std::move(places));
  std::vector<char> result;
  for (const Landmark& l : landmarks) {
    const int itself = l.width_m > kStake_m ? 1 : 0;
    const std::size_t num = things.within({l.x_m, l.y_m}, kNear_m).size();
    result.push_back(static_cast<int>(num) - itself >= kFewestOthers ? 1 : 0);
  }
  return result;
}

}  // namespace orchard::mapping
