// SPDX-License-Identifier: BSD-3-Clause
// Writes the source messages of a log as a recording folder, thinned, for a small recording in
// tests/data. Prints how many of each kind it wrote.
//   log_to_folder LOG FOLDER SCANS IMAGES   every SCANS-th scan, every IMAGES-th picture (0 = none)
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <variant>

#include "bus/messages/codec.hpp"
#include "io/log/log_reader.hpp"
#include "text/number_text.hpp"

namespace {

using namespace orchard;

class FolderWriter {
 public:
  FolderWriter(const std::string& folder, int scan_every, int image_every)
      : folder_(folder), scan_every_(scan_every), image_every_(image_every) {
    std::filesystem::create_directories(folder + "/images");
    scans_.open(folder + "/scans.csv");
    odometry_.open(folder + "/odometry.csv");
    poses_.open(folder + "/poses.csv");
    odometry_ << "utime_us,v_mps,yaw_rate_radps\n";
    poses_ << "utime_us,x_m,y_m,yaw_rad\n";
  }

  void operator()(const laser::Scan& scan) {
    if (num_scans_read_++ % scan_every_ != 0) return;
    if (num_scans_++ == 0) describe(scan);
    scans_ << scan.utime;
    for (const float range_m : scan.ranges_m)
      scans_ << ',' << (range_m > 0.0f ? fixed_text(range_m, 3) : "0");
    scans_ << '\n';
  }
  void operator()(const vision::Image& image) {
    if (image_every_ == 0 || num_images_read_++ % image_every_ != 0) return;
    ++num_images_;
    std::ofstream file(folder_ + "/images/" + std::to_string(image.utime) + ".jpg",
                       std::ios::binary);
    file.write(reinterpret_cast<const char*>(image.data.data()),
               static_cast<std::streamsize>(image.data.size()));
  }
  void operator()(const pose::Odometry& o) {
    odometry_ << o.utime << ',' << fixed_text(o.speed_mps, 4) << ','
              << fixed_text(o.yaw_rate_radps, 5) << '\n';
  }
  void operator()(const pose::PoseFix& fix) {
    if (!fix.has_yaw) return;
    poses_ << fix.utime << ',' << fixed_text(fix.x_m, 4) << ',' << fixed_text(fix.y_m, 4) << ','
           << fixed_text(fix.yaw_rad, 5) << '\n';
  }
  template <class Other>
  void operator()(const Other&) {}

  void finish() {
    if (num_scans_ == 0) throw std::runtime_error("the log holds no scan");
    if (!scans_.flush() || !odometry_.flush() || !poses_.flush()) {
      throw std::runtime_error(folder_ + " cannot be written");
    }
    std::printf("%s: %d scans, %d pictures\n", folder_.c_str(), num_scans_, num_images_);
  }

 private:
  void describe(const laser::Scan& scan) {
    scans_ << "utime_us";
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) scans_ << ",range_" << i << "_m";
    scans_ << '\n';
    std::ofstream file(folder_ + "/sensors.yaml");
    file << "laser:\n  num_beams: " << scan.ranges_m.size()
         << "\n  bearing_min_rad: " << fixed_text(scan.bearing_min_rad, 9)
         << "\n  bearing_step_rad: " << fixed_text(scan.bearing_step_rad, 9)
         << "\n  range_min_m: " << fixed_text(scan.range_min_m, 3)
         << "\n  range_max_m: " << fixed_text(scan.range_max_m, 3)
         << "\n  beam_period_us: " << fixed_text(scan.beam_period_us, 6) << "\n";
  }

  std::string folder_;
  int scan_every_;
  int image_every_;
  int num_scans_read_ = 0;
  int num_images_read_ = 0;
  int num_scans_ = 0;
  int num_images_ = 0;
  std::ofstream scans_;
  std::ofstream odometry_;
  std::ofstream poses_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: log_to_folder LOG FOLDER SCANS IMAGES\n");
    return 2;
  }
  try {
    FolderWriter writer(argv[2], std::stoi(argv[3]), std::stoi(argv[4]));
    io::LogReader reader(argv[1]);
    while (auto event = reader.next()) {
      const auto channel = bus::find_channel(event->channel);
      if (!channel || bus::info(*channel).role == bus::Role::kService) continue;
      const auto decoded = bus::decode(*channel, event->data.data(), event->data.size());
      if (const auto* message = std::get_if<bus::Message>(&decoded))
        std::visit([&](const auto& m) { writer(m); }, *message);
    }
    writer.finish();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "log_to_folder: %s\n", error.what());
    return 1;
  }
  return 0;
}
