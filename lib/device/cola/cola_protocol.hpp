// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "device/cola/cola_scan.hpp"
#include "device/scanner_talk.hpp"

namespace orchard::device {

/// The talk with a SICK scanner in CoLa-A (telegram listing 8014631): TiM3xx, TiM5xx, LMS1xx. Stops
/// it, asks what it is, asks for intensities if it may, and has it send every sweep.
///
/// CoLa-A has no check sum: over TCP none is needed, and of a telegram every field is checked.
class ColaProtocol : public ScannerTalk {
 public:
  ColaProtocol();

  void connected(std::int64_t host_utime) override;
  void receive(std::string_view bytes, std::int64_t host_utime) override;
  void expire(std::int64_t host_utime) override;

 private:
  /// In the order of the talk. Of those from kIdentify to kRun a device may refuse any.
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
