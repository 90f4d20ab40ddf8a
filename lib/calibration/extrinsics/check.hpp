// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibration/board/board_association.hpp"

namespace orchard::calibration {

/// Why a mount that was found cannot be that of the rig as its YAML states it, in words; empty
/// when they agree roughly (within 45 degrees).
///
/// A scanner sees one plane, so a mirrored picture cannot be told from a camera that is mounted
/// turned over: both give a proper rotation that explains every point. Only what the YAML states
/// of the mount can tell: a picture mirrored left to right looks like a camera upside down, one
/// mirrored top to bottom like a laser on the other side of the camera.
std::string mount_contradiction(const Mount& found, const Mount& stated);

}  // namespace orchard::calibration
