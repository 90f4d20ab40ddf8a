// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::mapping {

/// Configuration of the album, section `mapper.album`.
struct AlbumConfig {
  double max_mb = 8.0;  ///< limit on all photographs; 0: none are kept
};

template <class Visitor>
void describe(Visitor& v, AlbumConfig& c) {
  v.expert().number("max_mb", c.max_mb, 0, 1000, "MB",
                    "most that the photographs of trees and objects take; 0 = none are kept");
}

}  // namespace orchard::mapping
