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
                    "max size of all photographs of trees and objects; 0 = no photographs");
}

}  // namespace orchard::mapping
