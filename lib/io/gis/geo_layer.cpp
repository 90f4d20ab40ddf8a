// SPDX-License-Identifier: BSD-3-Clause
#include "io/gis/geo_layer.hpp"

namespace orchard::io {

void LayerFile::begin_layer(const GeoLayer& layer) {
  is_open_ = chosen_.empty() ? !has_one_layer_ || written_.empty() : chosen_ == layer.name;
  if (!is_open_) {
    left_out_.push_back(layer.name);
    return;
  }
  open_layer(layer);
  written_.emplace_back(layer.name, 0);
}

void LayerFile::add(const std::vector<GeoValue>& values,
                    const std::vector<Eigen::Vector2d>& points_map) {
  if (!is_open_) return;
  ++written_.back().second;
  write_feature(values, points_map);
}

}  // namespace orchard::io
