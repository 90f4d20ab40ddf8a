// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "device/cola/cola_scan.hpp"
#include "device/cola/cola_telegram.hpp"
#include "device/scanner_session.hpp"

namespace orchard::device {

/// CoLa protocol of SICK scanners TiM3xx, TiM5xx, TiM7xx, LMS1xx and LMS5xx (telegram listing
/// 8014631). Finds the dialect that the scanner speaks, stops it, identifies it, enables
/// intensities where permitted, and subscribes to every sweep.
///
/// CoLa-A has no checksum: TCP protects the bytes, and every field of a telegram is validated.
class ColaProtocol : public ScannerSession {
 public:
  ColaProtocol();

  void connected(std::int64_t host_utime) override;
  void receive(std::string_view bytes, std::int64_t host_utime) override;
  void expire(std::int64_t host_utime) override;

 private:
  /// The dialogue in order. The device may refuse any step from kIdentify to kRun.
  enum class Step { kStop, kIdentify, kRange, kLogin, kConfigure, kRun, kStart, kStream };

  std::string note() const override;
  void ask(Step step, std::int64_t host_utime);
  void ask_again(std::int64_t host_utime);
  void go_on(bool was_granted, std::int64_t host_utime);
  void take(const ColaPiece& piece, std::int64_t host_utime);
  void take_telegram(std::string_view telegram, std::int64_t host_utime);
  void take_answer(std::string_view kind, ColaFields fields, std::int64_t host_utime);
  void take_sweep(ColaFields fields, std::int64_t host_utime);
  std::int64_t utime_of(const ColaScan& sweep, std::int64_t host_utime);

  Step step_ = Step::kStop;
  ColaDialect dialect_ = ColaDialect::kA;  ///< in use, or being tried
  bool is_noise_ = false;                  ///< the last piece was no telegram
  ColaModel model_;
  std::optional<ColaRange> range_;
  /// A sweep was sent sooner after its start time than it lasts: that is not its first beam's.
  bool starts_late_ = false;
  std::optional<std::pair<std::uint32_t, std::uint32_t>> last_number_;  ///< counter, start time
};

}  // namespace orchard::device
