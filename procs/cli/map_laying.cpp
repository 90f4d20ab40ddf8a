// SPDX-License-Identifier: BSD-3-Clause
#include "cli/map_laying.hpp"

#include "io/file_error.hpp"

namespace orchard::cli {

mapping::DriveView view_of(const io::StoredMap& map, double reach_m) {
  mapping::SensorView view = map.view;
  if (reach_m > 0.0) view.reach_m = reach_m;
  return mapping::DriveView(map.landmarks, map.trajectories, view);
}

mapping::MapAlignment lay_on(const io::StoredMap& a, const mapping::DriveView& view_a,
                             const io::StoredMap& b, const mapping::DriveView& view_b,
                             const mapping::MapAlignmentConfig& config) {
  mapping::MapAlignment alignment =
      mapping::align_maps(a.landmarks, b.landmarks, view_a, view_b, config);
  switch (alignment.verdict) {
    case mapping::AlignmentVerdict::kAligned:
      break;
    case mapping::AlignmentVerdict::kAmbiguous:
      throw io::FileError(b.name + " cannot be laid on " + a.name +
                          " without doubt: " + alignment.reason +
                          "; if their frames agree better than that, say so with --max-offset");
    case mapping::AlignmentVerdict::kNone:
      throw io::FileError(b.name + " cannot be laid on " + a.name + ": " + alignment.reason +
                          (config.any_place ? "; are they of one orchard?"
                                            : "; are they of one orchard, and of one frame (else "
                                              "--any-place)?"));
  }
  return alignment;
}

}  // namespace orchard::cli
