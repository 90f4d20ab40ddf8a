// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "bus/node/node.hpp"
#include "io/config/config.hpp"
#include "viewer/live_box.hpp"
#include "viewer/live_page.hpp"
#include "viewer/page_server.hpp"
#include "viewer/row_survey.hpp"

namespace orchard::procs {

/// What orchard-viewer was asked for.
struct ViewerOptions {
  std::string listen;      ///< "ADDRESS", "ADDRESS:PORT", ":PORT"; empty: 127.0.0.1:8420 or next
  std::string token_file;  ///< whose first line is the token
  std::string folder;      ///< whose disk is watched
  std::string
      edit_folder;  ///< of the map, which people may correct on the page; empty: they may not
};

/// A viewer with everything round its node: the server, the survey of rows.
class ViewerProcess {
 public:
  /// Starts to serve. Throws std::runtime_error, io::FileError.
  std::unique_ptr<bus::Node> make_node(const io::Config& config, const ViewerOptions& options);

 private:
  std::unique_ptr<LiveBox> box_;
  std::unique_ptr<MapEditor> editor_;
  std::unique_ptr<LivePage> page_;
  std::unique_ptr<RowSurvey> survey_;
  std::unique_ptr<PageServer> server_;
};

/// Address and port of a --listen. Throws io::FileError for one that is none.
PageServerOptions parse_listen(const std::string& listen);

/// The token that a file's first line is. Throws io::FileError for one that is too weak.
std::string read_token(const std::string& path);

}  // namespace orchard::procs
