// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::io {

/// The folder of this program and its companion programs. Throws FileError.
std::string program_folder();

/// What a companion program of the same folder prints when it is run with these arguments; its
/// notes go on to stderr. For what only that program's libraries can read, so that others need not
/// load them. Throws FileError with the program's own message when it ends with an error, and when
/// it cannot be started.
std::string output_of_companion(const std::string& program,
                                const std::vector<std::string>& arguments);

}  // namespace orchard::io
