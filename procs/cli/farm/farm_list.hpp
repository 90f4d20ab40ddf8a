// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "cli/farm/farm_folder.hpp"
#include "farm/step_lots.hpp"

namespace orchard::cli {

/// Writes the copies of the rigs, work/tasks.json, the input of the steps, and work/lots.json, that
/// of the Snakefile. Throws io::SystemError.
void write_list(const FarmFolder& farm, const FarmContent& content,
                const std::vector<farm::FarmTask>& tasks, const farm::Lots& lots);

/// What makes a result: a command of `orchard`, in which "@out" stands for the folder; without
/// words the reason why there is none.
struct StepCommand {
  std::vector<std::string> words;
  std::string set_aside;
};

/// The steps that `farm run` has listed, for one of its jobs.
class StepList {
 public:
  /// Reads work/tasks.json. Throws io::SystemError.
  explicit StepList(const FarmFolder& farm);

  /// The steps of a lot, or the step itself. Throws io::SystemError for what is not listed.
  std::vector<std::string> steps_of(const std::string& lot) const;

  /// Whether all results that a step reads are there.
  bool can_begin(const std::string& step) const;

  /// The command of a step, as the results that it reads are.
  StepCommand command_of(const std::string& step) const;

  /// Throws io::SystemError unless the inputs of a step are those that its name stands for: files,
  /// earlier results, corrections and programs.
  void require_inputs(const std::string& step) const;

 private:
  const nlohmann::json& entry(const std::string& step) const;
  std::vector<std::string> good(const std::vector<std::string>& results) const;

  const FarmFolder& farm_;
  std::shared_ptr<const nlohmann::json> list_;
};

}  // namespace orchard::cli
