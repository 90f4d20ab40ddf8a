// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibration/board/board_association.hpp"

namespace orchard::calibration {

/// Explains why estimated extrinsics contradict those stated in the rig's YAML; empty when they
/// agree within 45 degrees.
///
/// A scanner sees one plane, so a mirrored image cannot be distinguished from a camera mounted the
/// other way round: both give a proper rotation that explains every point. Only the stated
/// extrinsics can decide: an image mirrored left to right looks like a camera upside down, one
/// mirrored top to bottom like a laser on the other side of the camera.
std::string extrinsics_contradiction(const RigidExtrinsics& found, const RigidExtrinsics& stated);

}  // namespace orchard::calibration
