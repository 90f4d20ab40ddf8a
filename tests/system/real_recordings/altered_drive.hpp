// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/recording/recording_folder.hpp"
#include "laser/scan.hpp"
#include "pose/measurements.hpp"

namespace orchard::test {

/// A scan, where the recording's track has base at its time, and what the altered drive is told.
struct Station {
  laser::Scan scan;
  pose::PoseFix track;               ///< as recorded, in the altered drive's frame
  std::optional<pose::PoseFix> fix;  ///< what becomes a POSE_FIX
};

using AlteredDrive = std::vector<Station>;

/// One way to make another drive of a recorded one.
struct Alteration {
  const char* name;
  const char* what;
  void (*apply)(AlteredDrive&, std::uint64_t seed);
  double fraction = 1.0;  ///< of the scans of a place that are left
};

/// All of them; the first leaves the drive as it is.
const std::vector<Alteration>& alterations();

/// The one of that name, or nullptr.
const Alteration* find_alteration(const std::string& name);

/// The recording's scans that have a POSE_FIX of the same time, altered. A pure function of
/// recording, alteration and seed.
AlteredDrive alter(const std::vector<io::SensorMessage>& recording, const Alteration& alteration,
                   std::uint64_t seed);

/// Scans and fixes in order of time, numbered.
std::vector<io::SensorMessage> messages_of(const AlteredDrive& drive);

/// Scans with the track instead of the fixes: to judge by.
std::vector<io::SensorMessage> tracked_messages_of(const AlteredDrive& drive);

}  // namespace orchard::test
