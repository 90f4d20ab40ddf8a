// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "device/cola/cola_scan.hpp"
#include "device/scanner_session.hpp"

namespace orchard::device {

/// CoLa-A protocol of SICK scanners TiM3xx, TiM5xx and LMS1xx (telegram listing 8014631). Stops the
/// scanner, identifies it, enables intensities where permitted, and subscribes to every sweep.
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

  void ask(Step step, std::int64_t host_utime);
  void ask_again(std::int64_t host_utime);
  void go_on(bool was_granted, std::int64_t host_utime);
  void take(std::string_view telegram, std::int64_t host_utime);
  void take_sweep(std::string_view telegram, std::int64_t host_utime);

  Step step_ = Step::kStop;
  ColaModel model_;
  std::optional<ColaRange> range_;
};

}  // namespace orchard::device
