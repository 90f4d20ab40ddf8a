// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "view/map_data.hpp"

namespace orchard::io {

class FileReplacement;

/// Reads the background of a map folder: background.jpg, and its corners in the map in
/// background.json. None: the folder has none. Throws FileError.
std::optional<view::Background> read_background(const std::string& folder);

/// Adds the two files to those that are written to `folder`.
void write_background(const std::string& folder, const view::Background& background,
                      FileReplacement& files);

/// Gives a map folder a background, in its map.html too; all files or none. Throws FileError.
void set_background(const std::string& folder, const view::Background& background);

}  // namespace orchard::io
