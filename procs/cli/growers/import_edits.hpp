// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::cli {

/// `orchard import-edits MAP EDITED.gpkg`.
struct ImportEditsOptions {
  std::string map_folder;
  std::string edited_path;
  std::string who;
  bool keep_missing = false;  ///< what the file lacks was not deleted
  bool dry_run = false;
  bool json = false;
};

/// Adds what somebody changed in a map's GeoPackage to the map's corrections; returns the exit
/// code: 3 when something was in conflict, the rest is added all the same. Throws io::FileError.
int run_import_edits(const ImportEditsOptions& options);

}  // namespace orchard::cli
