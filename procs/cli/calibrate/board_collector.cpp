// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/board_collector.hpp"

#include <utility>

#include "calibration/board/grey_picture.hpp"

namespace orchard::cli {

BoardCollector::BoardCollector(const io::Config& config, const calibration::BoardConfig& board)
    : intrinsics_(config.camera.intrinsics),
      board_(board),
      pairer_(config.detector.pairing_tolerance_s, config.detector.image_wait_s) {}

std::vector<bus::Channel> BoardCollector::inputs() const {
  return {bus::Channel::kScan, bus::Channel::kImage};
}

void BoardCollector::handle(const bus::Message& input, const bus::Outbox&) {
  if (const auto* scan = std::get_if<laser::Scan>(&input)) {
    ++num_scans_;
    for (const auto& pair : pairer_.add(*scan)) observe(pair);
  } else if (const auto* image = std::get_if<vision::Image>(&input)) {
    ++num_images_;
    if (image->width_px != intrinsics_.width_px || image->height_px != intrinsics_.height_px) {
      ++num_wrong_size_;
      wrong_size_ = std::to_string(image->width_px) + "x" + std::to_string(image->height_px);
      return;
    }
    for (const auto& pair : pairer_.add(*image)) observe(pair);
  }
}

void BoardCollector::flush(const bus::Outbox&) {
  for (const auto& pair : pairer_.flush()) observe(pair);
}

void BoardCollector::observe(const detection::ScanImagePair& pair) {
  if (!pair.image) return;
  ++num_pairs_;
  const auto grey = calibration::grey_of(*pair.image);
  if (!grey) {
    ++num_unreadable_;
    return;
  }
  if (auto board = calibration::find_board(*grey, board_)) {
    pairs_.push_back({pair.scan, std::move(*board)});
  }
}

}  // namespace orchard::cli
