// SPDX-License-Identifier: BSD-3-Clause
// What tests/benchmark/slam_peers.sh needs: one drive for every competitor, our own run through it,
// and one judge for all. Used through that script.
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/opengl/CEllipsoid2D.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CSetOfObjects.h>
#include <mrpt/serialization/CArchive.h>

#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <stdexcept>
#include <string>

#include "benchmark/slam_peers/recorded_drive.hpp"
#include "evaluation/map_alignment.hpp"
#include "geometry/rigid_fit2.hpp"
#include "pose/slam/trunk_slam.hpp"

namespace {

using namespace orchard;
using evaluation::Point;

constexpr double kGateM = 0.5;  // a landmark farther from its tree is none of it

std::vector<Point> read_points(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error("cannot read " + path);
  std::vector<Point> points;
  for (Point p; in >> p.x_m >> p.y_m;) points.push_back(p);
  return points;
}

void write_points(const std::string& path, const std::vector<Point>& points) {
  std::ofstream out(path);
  out << std::setprecision(9);
  for (const Point& p : points) out << p.x_m << ' ' << p.y_m << '\n';
  if (!out.flush()) throw std::runtime_error("cannot write " + path);
}

void write_drive(const bench::RecordedDrive& drive, const std::string& folder) {
  write_rawlog(drive, bench::Sightings::kUnknown, folder + "/unknown.rawlog");
  write_rawlog(drive, bench::Sightings::kIdentified, folder + "/identified.rawlog");
  write_rawlog(drive, bench::Sightings::kScan, folder + "/scan.rawlog");
  std::printf("%zu trees %zu steps\n", drive.trees.size(), drive.steps.size());
}

/// Runs our own SLAM through the drive; prints its processor time [s] alone.
void run_ours(const bench::RecordedDrive& drive, const std::string& folder) {
  std::vector<Point> path;
  pose::TrunkSlam slam{pose::PoseConfig{}};
  const std::clock_t began = std::clock();
  for (std::size_t i = 0; i < drive.steps.size(); ++i) {
    for (const pose::Odometry& odometry : drive.odometry[i]) slam.add(odometry);
    slam.add(pose::Measurement(drive.steps[i].seen));
    const auto pose = slam.estimate();
    path.push_back(pose ? Point{pose->x_m, pose->y_m} : Point{});
    slam.take_correction();
  }
  slam.finish();
  std::printf("%.3f\n", static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC);
  std::vector<Point> landmarks;
  for (const pose::SlamLandmark& l : slam.graph().landmarks) {
    if (l.confirmed && l.keyframes.size() >= 5) landmarks.push_back({l.p_map.x(), l.p_map.y()});
  }
  write_points(folder + "/path.txt", path);
  write_points(folder + "/landmarks.txt", landmarks);
}

/// Prints "path RMS [m], landmark RMS [m], missed, beyond one per tree": the path as it was told on
/// the way, aligned to the true one; the landmarks aligned on the trees themselves.
void judge(const bench::RecordedDrive& drive, const std::string& folder) {
  std::vector<Point> truth;
  for (const bench::DriveStep& step : drive.steps) {
    truth.push_back({step.T_start_base.x(), step.T_start_base.y()});
  }
  std::vector<Point> path = read_points(folder + "/path.txt");
  if (path.size() < truth.size() / 2) {
    std::printf("- - - -\n");
    return;
  }
  truth.resize(std::min(truth.size(), path.size()));
  path.resize(truth.size());
  const geometry::Pose2 T_truth_path =
      geometry::fit_rigid({truth.begin(), truth.end()}, {path.begin(), path.end()}).T_a_b;
  double sum = 0.0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Point p = transform(T_truth_path, path[i]);
    sum += std::pow(p.x_m - truth[i].x_m, 2) + std::pow(p.y_m - truth[i].y_m, 2);
  }
  std::printf("%.3f", std::sqrt(sum / static_cast<double>(path.size())));

  std::vector<Point> trees;
  for (const Eigen::Vector2d& tree : drive.trees) trees.push_back({tree.x(), tree.y()});
  std::vector<Point> found = read_points(folder + "/landmarks.txt");
  const auto T_truth_map = found.empty()
                               ? std::nullopt
                               : evaluation::align_points(trees, found, kGateM, {}, T_truth_path);
  if (!T_truth_map) {
    std::printf(" - - -\n");
    return;
  }
  for (Point& p : found) p = transform(*T_truth_map, p);
  const evaluation::Assignment pairs = evaluation::assign(trees, found, kGateM);
  int matched = 0;
  sum = 0.0;
  for (std::size_t i = 0; i < trees.size(); ++i) {
    if (pairs[i] == evaluation::kUnmatched) continue;
    const Point& p = found[static_cast<std::size_t>(pairs[i])];
    sum += std::pow(p.x_m - trees[i].x_m, 2) + std::pow(p.y_m - trees[i].y_m, 2);
    ++matched;
  }
  std::printf(" %.3f %d %d\n", std::sqrt(sum / std::max(1, matched)),
              static_cast<int>(trees.size()) - matched, static_cast<int>(found.size()) - matched);
}

/// Adds the middle of every ellipse drawn in a set, and of the sets within it.
void add_ellipses(const mrpt::opengl::CSetOfObjects& set, std::vector<Point>& points) {
  for (const auto& object : set) {
    if (const auto inner = std::dynamic_pointer_cast<mrpt::opengl::CSetOfObjects>(object)) {
      add_ellipses(*inner, points);
    } else if (std::dynamic_pointer_cast<mrpt::opengl::CEllipsoid2D>(object)) {
      points.push_back({object->getPoseX(), object->getPoseY()});
    }
  }
}

/// The landmarks that kf-slam has drawn in its last scene, behind the robot itself: the one file
/// of it that holds them (its MATLAB scripts of planar maps lack one coordinate).
void extract_landmarks(const std::string& scene_path, const std::string& folder) {
  mrpt::io::CFileGZInputStream in(scene_path);
  mrpt::opengl::COpenGLScene scene;
  mrpt::serialization::archiveFrom(in) >> scene;
  std::vector<Point> points;
  for (const auto& object : *scene.getViewport("main")) {
    if (const auto set = std::dynamic_pointer_cast<mrpt::opengl::CSetOfObjects>(object)) {
      add_ellipses(*set, points);
    }
  }
  if (!points.empty()) points.erase(points.begin());
  write_points(folder + "/landmarks.txt", points);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc == 4 && std::string(argv[1]) == "landmarks") {
    extract_landmarks(argv[2], argv[3]);
    return 0;
  }
  if (argc != 5) {
    std::cerr
        << "usage: slam_peers write|ours|judge SEED TREES FOLDER | landmarks SCENE FOLDER; see "
           "slam_peers.sh\n";
    return 2;
  }
  const std::string what = argv[1];
  const bench::RecordedDrive drive = bench::record_drive(std::stoull(argv[2]), std::stoi(argv[3]));
  if (what == "write") {
    write_drive(drive, argv[4]);
  } else if (what == "ours") {
    run_ours(drive, argv[4]);
  } else if (what == "judge") {
    judge(drive, argv[4]);
  } else {
    throw std::runtime_error("unknown step " + what);
  }
  return 0;
} catch (const std::exception& error) {
  std::cerr << "slam_peers: " << error.what() << '\n';
  return 3;
}
