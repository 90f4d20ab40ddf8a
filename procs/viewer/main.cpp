// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/process.hpp"
#include "io/config/config.hpp"
#include "viewer/viewer_process.hpp"

int main(int argc, char** argv) {
  orchard::procs::ViewerOptions options;
  orchard::bus::ProcessInfo info;
  info.name = "orchard-viewer";
  info.description =
      "Serves a page on which a browser shows the drive as it goes: the growing map, the robot, "
      "the "
      "scan, the camera's picture, how each process is.\n"
      "Listens to SCAN, IMAGE, DETECTIONS, POSE, TRAJECTORY, MAP and STATUS; only with --edit "
      "anything is written.";
  info.options.push_back({"--listen", "ADDRESS:PORT",
                          "where the page is (127.0.0.1:8420, or the next port that is free)",
                          &options.listen});
  info.options.push_back(
      {"--token-file", "FILE",
       "whose first line lets other hosts look on (and edit, with --edit): http://...?token=TOKEN",
       &options.token_file});
  info.options.push_back({"--folder", "DIR",
                          "of the map or recording: how much of its disk is left",
                          &options.folder});
  info.options.push_back({"--edit", "DIR",
                          "the map's folder: whoever sees the page may correct the map",
                          &options.edit_folder});
  orchard::io::RigFile rig;
  orchard::procs::ViewerProcess viewer;
  return orchard::bus::run_node_process(argc, argv, info, rig,
                                        [&] { return viewer.make_node(rig.config(), options); });
}
