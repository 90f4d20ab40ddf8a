// SPDX-License-Identifier: BSD-3-Clause
#include "farm/cost_fit.hpp"

#include <Eigen/Dense>
#include <limits>

namespace orchard::farm {
namespace {

/// Non-negative least squares by trying every subset of columns, of which there are at most eight.
Eigen::VectorXd non_negative(const Eigen::MatrixXd& columns, const Eigen::VectorXd& values) {
  const auto num = static_cast<unsigned>(columns.cols());
  Eigen::VectorXd best = Eigen::VectorXd::Zero(num);
  double least = std::numeric_limits<double>::max();
  for (unsigned set = 1; set < (1U << num); ++set) {
    std::vector<Eigen::Index> in;
    for (unsigned c = 0; c < num; ++c) {
      if ((set >> c & 1U) != 0) in.push_back(static_cast<Eigen::Index>(c));
    }
    const Eigen::MatrixXd some = columns(Eigen::all, in);
    const Eigen::VectorXd x = some.colPivHouseholderQr().solve(values);
    if (!x.allFinite() || x.minCoeff() < 0.0) continue;
    const double error = (some * x - values).squaredNorm();
    if (error >= least) continue;
    least = error;
    best.setZero();
    for (std::size_t i = 0; i < in.size(); ++i) best[in[i]] = x[static_cast<Eigen::Index>(i)];
  }
  return best;
}

}  // namespace

CostFit fit_costs(const std::vector<CostSample>& samples) {
  // Before the first map: three times the cost of a map of the simulated orchard.
  if (samples.empty())
    return {{1.0, 6.0, 0.01, 0.0}, {100, 64, 0.07, 0}, {3, 0, 0, 0.1}, {300, 0, 0, 2}};
  const auto num = static_cast<Eigen::Index>(samples.size());
  Eigen::MatrixXd by_way(num, 3), by_log(num, 2);
  Eigen::VectorXd time_s(num), memory_mb(num);
  for (Eigen::Index i = 0; i < num; ++i) {
    const CostSample& s = samples[static_cast<std::size_t>(i)];
    by_way.row(i) << 1.0, s.way_km, s.num_trees;
    by_log.row(i) << 1.0, s.log_mb;
    time_s[i] = s.processor_s;
    memory_mb[i] = s.memory_mb;
  }
  const auto way_line = [&](const Eigen::VectorXd& values) {
    const Eigen::VectorXd x = non_negative(by_way, values);
    return CostLine{x[0], x[1], x[2], 0.0};
  };
  const auto log_line = [&](const Eigen::VectorXd& values) {
    const Eigen::VectorXd x = non_negative(by_log, values);
    return CostLine{x[0], 0.0, 0.0, x[1]};
  };
  return {way_line(time_s), way_line(memory_mb), log_line(time_s), log_line(memory_mb)};
}

}  // namespace orchard::farm
