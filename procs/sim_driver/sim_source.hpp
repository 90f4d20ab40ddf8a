// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "bus/driver/source.hpp"
#include "io/config/config.hpp"
#include "simulation/simulator.hpp"

namespace orchard::procs {

/// What orchard-sim-driver takes beyond the common options, as typed.
struct SimDriverOptions {
  std::string scene = "tubes";
  std::string seed = "1";
  std::string truth_path;  ///< CSV of what stands there; empty = do not write
  std::string poses_path;  ///< CSV of where base truly was; empty = do not write
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

/// The source that the options ask for; writes the truth files before anything is published.
/// Throws std::invalid_argument for a scene or seed that is none, io::FileError for the files.
std::unique_ptr<SimSource> make_sim_source(const SimDriverOptions& options,
                                           const io::Config& config);

}  // namespace orchard::procs
