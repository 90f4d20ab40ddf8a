// SPDX-License-Identifier: BSD-3-Clause
// Forwards commands between the programs. All programs parse the same command line. A command that
// is not linked into this program is run by the companion program that has it, so that the mapping
// program neither builds nor loads the code of calibration, import and reports. The definitions
// here are weak: those in a command's own file replace them where it is linked.
#include "cli/replace_by_program.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "cli/calibrate/calibrate_camera.hpp"
#include "cli/calibrate/calibrate_delay.hpp"
#include "cli/calibrate/calibrate_laser_camera.hpp"
#include "cli/calibrate/calibrate_probability.hpp"
#include "cli/calibrate/calibrate_trunks.hpp"
#include "cli/evaluate/evaluate.hpp"
#include "cli/evaluate/evaluate_trajectory.hpp"
#include "cli/farm/farm_files.hpp"
#include "cli/farm/farm_run.hpp"
#include "cli/farm/farm_status.hpp"
#include "cli/farm/farm_step.hpp"
#include "cli/field/live.hpp"
#include "cli/field/record.hpp"
#include "cli/field/status.hpp"
#include "cli/growers/edit.hpp"
#include "cli/growers/export.hpp"
#include "cli/growers/import_edits.hpp"
#include "cli/growers/plan.hpp"
#include "cli/growers/publish.hpp"
#include "cli/growers/report.hpp"
#include "cli/logs/echo.hpp"
#include "cli/logs/import.hpp"
#include "cli/logs/log_commands.hpp"
#include "cli/logs/log_mcap.hpp"
#include "cli/logs/simulate.hpp"
#include "cli/logs/simulate_board.hpp"
#include "cli/maps/compare.hpp"
#include "cli/maps/map.hpp"
#include "cli/maps/merge.hpp"
#include "cli/program_folder.hpp"
#include "cli/rig/doctor.hpp"
#include "cli/rig/overlay.hpp"
#include "cli/view/view.hpp"
#include "io/file_error.hpp"

namespace orchard::cli {
namespace {

/// The arguments of this process, each null-terminated.
std::string own_command_line() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

void replace_by_program(const char* program) {
  const std::string path = program_folder() + "/" + program;
  std::string words = own_command_line();
  std::vector<char*> arguments;
  for (std::size_t begin = 0, end; (end = words.find('\0', begin)) != words.npos; begin = end + 1) {
    arguments.push_back(&words[begin]);
  }
  arguments.push_back(nullptr);
  errno = ENOENT;
  if (arguments.size() > 1) execv(path.c_str(), arguments.data());
  throw io::FileError(
      path + ": could not be started (" + std::strerror(errno) +
      "); it must be in the same folder as orchard: build it with `scripts/build.sh " + program +
      "`");
}

#define ORCHARD_RUNS_IN(program, function, Options) \
  [[gnu::weak]] int function(const Options&) { replace_by_program(program); }

ORCHARD_RUNS_IN("orchard", run_doctor, DoctorOptions)
ORCHARD_RUNS_IN("orchard", run_echo, EchoOptions)
ORCHARD_RUNS_IN("orchard", run_evaluate, EvaluateOptions)
ORCHARD_RUNS_IN("orchard", run_evaluate_trajectory, EvaluateTrajectoryOptions)
ORCHARD_RUNS_IN("orchard", run_live, LiveOptions)
ORCHARD_RUNS_IN("orchard", run_log_check, LogOptions)
ORCHARD_RUNS_IN("orchard", run_log_config, LogOptions)
ORCHARD_RUNS_IN("orchard", run_log_info, LogOptions)
ORCHARD_RUNS_IN("orchard", run_log_repair, LogOptions)
ORCHARD_RUNS_IN("orchard", run_map, MapOptions)
ORCHARD_RUNS_IN("orchard", run_overlay, OverlayOptions)
ORCHARD_RUNS_IN("orchard", run_record, RecordOptions)
ORCHARD_RUNS_IN("orchard", run_simulate, SimulateOptions)
ORCHARD_RUNS_IN("orchard", run_status, StatusOptions)

// Commands for rigs.
ORCHARD_RUNS_IN("orchard-calibrate", run_calibrate_camera, CalibrateCameraOptions)
ORCHARD_RUNS_IN("orchard-calibrate", run_calibrate_delay, CalibrateDelayOptions)
ORCHARD_RUNS_IN("orchard-calibrate", run_calibrate_laser_camera, CalibrateLaserCameraOptions)
ORCHARD_RUNS_IN("orchard-calibrate", run_calibrate_probability, CalibrateProbabilityOptions)
ORCHARD_RUNS_IN("orchard-calibrate", run_calibrate_trunks, CalibrateTrunksOptions)
ORCHARD_RUNS_IN("orchard-calibrate", run_simulate_board, SimulateOptions)

// Commands for recordings of other systems.
ORCHARD_RUNS_IN("orchard-import", run_import, ImportOptions)
ORCHARD_RUNS_IN("orchard-import", run_log_mcap, LogMcapOptions)

// Commands for finished maps.
ORCHARD_RUNS_IN("orchard-maps", run_compare, CompareOptions)
ORCHARD_RUNS_IN("orchard-maps", run_edit, EditOptions)
ORCHARD_RUNS_IN("orchard-maps", run_edit_apply, EditOptions)
ORCHARD_RUNS_IN("orchard-maps", run_edit_check, EditOptions)
ORCHARD_RUNS_IN("orchard-maps", run_edit_list, EditOptions)
ORCHARD_RUNS_IN("orchard-maps", run_export, ExportOptions)
ORCHARD_RUNS_IN("orchard-maps", run_farm_add, FarmAddOptions)
ORCHARD_RUNS_IN("orchard-maps", run_farm_init, FarmInitOptions)
ORCHARD_RUNS_IN("orchard-maps", run_farm_publish, FarmPublishOptions)
ORCHARD_RUNS_IN("orchard-maps", run_farm_run, FarmRunOptions)
ORCHARD_RUNS_IN("orchard-maps", run_farm_status, FarmStatusOptions)
ORCHARD_RUNS_IN("orchard-maps", run_farm_step, FarmStepOptions)
ORCHARD_RUNS_IN("orchard-maps", run_import_edits, ImportEditsOptions)
ORCHARD_RUNS_IN("orchard-maps", run_merge, MergeOptions)
ORCHARD_RUNS_IN("orchard-maps", run_plan, PlanOptions)
ORCHARD_RUNS_IN("orchard-maps", run_publish, PublishOptions)
ORCHARD_RUNS_IN("orchard-maps", run_report, ReportOptions)
ORCHARD_RUNS_IN("orchard-maps", run_view, ViewOptions)

}  // namespace orchard::cli
