// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "bus/driver/source.hpp"
#include "io/config/config.hpp"
#include "simulation/simulator.hpp"

namespace orchard::procs {

/// Command-line options of orchard-sim-driver beyond the common ones, as typed.
struct SimDriverOptions {
  std::string scene = "tubes";
  std::string seed = "1";
  std::string truth_path;  ///< CSV of the true objects; empty: do not write
  std::string poses_path;  ///< CSV of the true poses of base; empty: do not write
};

/// A simulated robot as a source of messages.
class SimSource : public bus::Source {
 public:
  SimSource(simulation::SceneKind kind, std::uint64_t seed, const simulation::RigConfig& rig);

  std::optional<bus::Message> next() override;
  std::optional<double> duration_s() const override;
  const simulation::Simulator& simulator() const { return simulator_; }

 private:
  simulation::Simulator simulator_;
};

/// Makes the source for the options; writes the truth files before the first message. Throws
/// std::invalid_argument for an unknown scene or an invalid seed, io::FileError for the files.
std::unique_ptr<SimSource> make_sim_source(const SimDriverOptions& options,
                                           const io::Config& config);

}  // namespace orchard::procs
