// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

namespace orchard::io {

/// Creates a folder and its parents if they are missing. Throws FileError; `advice`, if given, is
/// the remedy at the end of the message.
void make_folder(const std::string& folder, const std::string& advice = {});

/// Removes the files of a folder that `is_ours` and are not in `names`, and the folder if `names`
/// is empty and nothing else is in it. Does nothing if there is no such folder.
void remove_other_files(const std::string& folder, const std::set<std::string>& names,
                        const std::function<bool(const std::string& name)>& is_ours);

/// The path of that file in a folder; the path itself if it is no folder's.
std::string file_in(const std::string& folder_or_file, const char* name);

/// Lists the names in a folder, sorted; empty if it cannot be read.
std::vector<std::string> folder_names(const std::string& folder);

}  // namespace orchard::io
