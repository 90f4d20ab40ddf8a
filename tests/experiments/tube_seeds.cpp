// SPDX-License-Identifier: BSD-3-Clause
// Maps the tube scene over many seeds and prints the distributions beside the paper's tables.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

#include "system/tube_scene/tube_scene_run.hpp"

namespace {

using orchard::evaluation::EvaluatedObject;
using orchard::evaluation::MapEvaluation;

/// A row of tables 1 and 2 of Shalal et al. 2013.
struct PaperRow {
  const char* name;
  int n;
  double roc, se_x_mm, se_y_mm;
};

constexpr PaperRow kPaper[] = {
    {"T1", 5, 0.903, 6.40, 8.33},  {"T2", 5, 0.888, 6.09, 9.76},  {"T3", 6, 0.867, 3.32, 7.54},
    {"T4", 8, 0.890, 5.77, 8.57},  {"T5", 6, 0.883, 8.20, 9.91},  {"T6", 8, 0.854, 8.55, 8.17},
    {"T7", 7, 0.885, 5.03, 7.09},  {"T8", 6, 0.875, 4.31, 7.90},  {"T9", 6, 0.860, 3.72, 3.75},
    {"T10", 6, 0.877, 4.31, 7.90}, {"T11", 5, 0.786, 8.18, 5.08}, {"T12", 5, 0.878, 8.70, 2.85},
    {"B1", 5, 0.0009, 2.95, 5.41}, {"B2", 5, 0.461, 3.40, 5.66},  {"B3", 5, 0.0012, 5.63, 4.21},
    {"B4", 5, 0.0008, 5.51, 5.91}};

/// Least, mean and largest of a set of figures.
class Spread {
 public:
  void add(double value) {
    least_ = count_ == 0 ? value : std::min(least_, value);
    most_ = count_ == 0 ? value : std::max(most_, value);
    sum_ += value;
    ++count_;
  }
  double mean() const { return count_ > 0 ? sum_ / count_ : 0.0; }
  double least() const { return least_; }
  double most() const { return most_; }

 private:
  double sum_ = 0.0, least_ = 0.0, most_ = 0.0;
  int count_ = 0;
};

struct Row {
  Spread n, roc, se_x_mm, se_y_mm, error_mm;
};

void add(const EvaluatedObject& object, Row& row) {
  if (!object.landmark) return;
  row.n.add(object.landmark->num_observations);
  row.roc.add(object.landmark->roc_mean);
  row.se_x_mm.add(1e3 * object.landmark->se_x_m);
  row.se_y_mm.add(1e3 * object.landmark->se_y_m);
  row.error_mm.add(1e3 * object.error_m);
}

void print_rows(const std::vector<Row>& rows) {
  std::printf(
      "          N            ROC_tree_mean                 SE_x (mm)           SE_y (mm)"
      "           error (mm)\n");
  std::printf(
      "     paper mean    paper  mean  least - most     paper  mean  most   paper  mean"
      "  most   mean  most\n");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& r = rows[i];
    const PaperRow& p = kPaper[i];
    std::printf(
        "%-4s %5d %4.1f   %6.4f %6.4f %6.4f - %6.4f  %5.2f %5.2f %5.2f   %5.2f %5.2f %5.2f"
        "  %5.1f %5.1f\n",
        p.name, p.n, r.n.mean(), p.roc, r.roc.mean(), r.roc.least(), r.roc.most(), p.se_x_mm,
        r.se_x_mm.mean(), r.se_x_mm.most(), p.se_y_mm, r.se_y_mm.mean(), r.se_y_mm.most(),
        r.error_mm.mean(), r.error_mm.most());
  }
}

void print_scene_figure(const char* what, const char* paper, const char* wanted, const Spread& s) {
  std::printf("%-34s paper %-6s wanted %-14s mean %6.3f  least %6.3f  most %6.3f\n", what, paper,
              wanted, s.mean(), s.least(), s.most());
}

int run(const std::string& config_path, unsigned long first, unsigned long last) {
  const orchard::io::Config config = orchard::io::load_config(config_path);
  std::vector<Row> rows(std::size(kPaper));
  Spread roc, se_x_mm, se_y_mm, rms_mm;
  int num_good = 0;
  for (unsigned long seed = first; seed <= last; ++seed) {
    const MapEvaluation evaluation = orchard::test::run_tube_scene(seed, config);
    for (std::size_t i = 0; i < std::min(rows.size(), evaluation.objects.size()); ++i) {
      add(evaluation.objects[i], rows[i]);
    }
    roc.add(evaluation.roc_mean_trees);
    se_x_mm.add(1e3 * evaluation.se_x_mean_m);
    se_y_mm.add(1e3 * evaluation.se_y_mean_m);
    rms_mm.add(1e3 * evaluation.all.rms_m);
    const auto complaints = orchard::test::shortcomings(evaluation);
    for (const std::string& complaint : complaints) {
      std::printf("seed %lu: %s\n", seed, complaint.c_str());
    }
    if (complaints.empty()) ++num_good;
  }
  print_rows(rows);
  print_scene_figure("mean roc over a scene's trees", "0.870", "0.78 to 0.95", roc);
  print_scene_figure("mean SE in x over its trees (mm)", "6.05", "at most 7", se_x_mm);
  print_scene_figure("mean SE in y over its trees (mm)", "7.24", "at most 7", se_y_mm);
  print_scene_figure("error against truth, RMS (mm)", "-", "at most 15", rms_mm);
  const auto num_seeds = last - first + 1;
  std::printf(
      "%d of %lu scenes with 12 of 12 trees, 4 of 4 objects, nothing else, and all limits "
      "kept\n",
      num_good, num_seeds);
  return static_cast<unsigned long>(num_good) == num_seeds ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: tube_seeds CONFIG FIRST_SEED LAST_SEED\n");
    return 2;
  }
  try {
    const unsigned long first = std::stoul(argv[2]), last = std::stoul(argv[3]);
    if (last < first) throw std::invalid_argument("the last seed comes before the first");
    return run(argv[1], first, last);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "tube_seeds: %s\n", error.what());
    return 3;
  }
}
