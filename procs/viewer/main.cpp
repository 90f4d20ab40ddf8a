// SPDX-License-Identifier: BSD-3-Clause
#include "bus/process/process.hpp"
#include "io/config/config.hpp"
#include "viewer/viewer_process.hpp"

int main(int argc, char** argv) {
  orchard::procs::ViewerOptions options;
  orchard::bus::ProcessInfo info;
  info.name = "orchard-viewer";
  info.description =
      "Serve a live web page of the drive: map, robot, scan, picture and the status of each "
      "process.\n"
      "Reads SCAN, IMAGE, DETECTIONS, POSE, TRAJECTORY, MAP and STATUS; sends nothing and writes "
      "only\n"
      "corrections (--edit).";
  info.options.push_back({"--listen", "ADDRESS:PORT",
                          "address of the page [127.0.0.1:8420, or the next free port]",
                          &options.listen});
  info.options.push_back(
      {"--token-file", "FILE",
       "file whose first line is the token for other hosts: http://...?token=TOKEN",
       &options.token_file});
  info.options.push_back({"--folder", "DIR",
                          "folder of the map or recording, to show the free space of its disk",
                          &options.folder});
  info.options.push_back({"--edit", "DIR",
                          "folder of the map; allow everyone who can open the page to correct it",
                          &options.edit_folder});
  orchard::io::RigFile rig;
  orchard::procs::ViewerProcess viewer;
  return orchard::bus::run_node_process(argc, argv, info, rig,
                                        [&] { return viewer.make_node(rig.config(), options); });
}
