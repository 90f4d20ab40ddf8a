// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::farm {

/// The files of one drive.
struct DrivePieces {
  std::string name;                ///< without .lcm and the number of a piece
  std::vector<std::string> files;  ///< in order of their numbers
  std::string missing;             ///< numbers of pieces that are not there: "0-2, 5"; empty: none
};

/// Whether a file's name is that of a log or a piece of one: NAME.lcm, or NAME.lcm.00 of
/// lcm-logger.
bool is_log_name(const std::string& file);

/// Sorts the logs of one robot on one date into drives. NAME.lcm is a drive; NAME.lcm.00,
/// NAME.lcm.01 ... (lcm-logger) are one, and so are NAME-000.lcm, NAME-001.lcm ... (LogRecorder),
/// the oldest of which may have been deleted. One NAME-NNN.lcm alone that is not the first is a
/// drive of that name. Names that are not is_log_name() are left out. The order of `files` does not
/// matter.
std::vector<DrivePieces> drives_of_files(const std::vector<std::string>& files);

}  // namespace orchard::farm
