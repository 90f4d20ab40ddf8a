// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "device/cola/cola_scan.hpp"
#include "device/device_clock.hpp"
#include "device/protocol.hpp"

namespace orchard::device {

/// The talk with a SICK scanner in CoLa-A (telegram listing 8014631): TiM3xx, TiM5xx, LMS1xx. Stops
/// it, asks what it is, asks for intensities if it may, and has it send every sweep.
///
/// CoLa-A has no check sum: over TCP none is needed, and of a telegram every field is checked.
class ColaProtocol : public Protocol {
 public:
  ColaProtocol();

  void connected(std::int64_t host_utime) override;
  void receive(std::string_view bytes, std::int64_t host_utime) override;
  std::optional<std::int64_t> deadline() const override { return deadline_utime_; }
  void expire(std::int64_t host_utime) override;
  void host_clock_stepped(std::int64_t step_us) override;
  std::string failure() const override { return failure_; }
  std::string condition() const override;
  ProtocolCounts counts() const override { return counts_; }

  const DeviceClock& clock() const { return clock_; }

 private:
  /// In the order of the talk. Of those from kIdentify to kRun a device may refuse any.
  enum class Step { kStop, kIdentify, kRange, kLogin, kConfigure, kRun, kStart, kStream };

  void fail(const std::string& why);
  void ask(Step step, std::int64_t host_utime);
  void ask_again(std::int64_t host_utime);
  void go_on(bool was_granted, std::int64_t host_utime);
  void take(std::string_view telegram, std::int64_t host_utime);
  void take_sweep(std::string_view telegram, std::int64_t host_utime);

  DeviceClock clock_;
  ProtocolCounts counts_;
  std::string buffer_;
  Step step_ = Step::kStop;
  std::optional<std::int64_t> deadline_utime_;
  int num_asked_ = 0;
  ColaModel model_;
  std::optional<ColaRange> range_;
  bool is_streaming_ = false;  ///< a sweep has come in this talk
  std::optional<std::int64_t> last_utime_;
  std::string trouble_;  ///< what the scanner says is wrong with it
  std::string failure_;
};

}  // namespace orchard::device
