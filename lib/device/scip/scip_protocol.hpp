// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "device/scanner_session.hpp"
#include "device/scip/scip_parameters.hpp"
#include "device/scip/scip_sweep.hpp"
#include "device/scip/scip_text.hpp"

namespace orchard::device {

/// SCIP protocol, 2.0 or later, of Hokuyo scanners URG-04LX-UG01, UTM-30LX, UST-10LX and similar
/// (specification C-42-03320B). Stops the scanner, reads its parameters and its clock, and requests
/// every sweep, with intensities where the model has them.
class ScipProtocol : public ScannerSession {
 public:
  ScipProtocol();

  void connected(std::int64_t host_utime) override;
  void receive(std::string_view bytes, std::int64_t host_utime) override;
  void expire(std::int64_t host_utime) override;

 private:
  /// The dialogue in order.
  enum class Step { kStop, kParameters, kState, kClockIn, kClockRead, kClockOut, kLaser, kStream };

  void ask(Step step, std::int64_t host_utime);
  void ask_again(std::int64_t host_utime);
  void begin_stream(ScipEncoding encoding, std::int64_t host_utime);
  void take(const ScipReply& reply, std::int64_t host_utime);
  void take_parameters(const ScipReply& reply, std::int64_t host_utime);
  void take_clock_reading(const ScipReply& reply, std::int64_t host_utime);
  void take_stream(const ScipReply& reply, std::int64_t host_utime);
  void take_sweep(const ScipReply& reply, std::int64_t host_utime);
  void refuse_stream(std::string_view status, std::int64_t host_utime);
  bool is_answer(std::string_view echo) const;

  Step step_ = Step::kStop;
  int num_readings_ = 0;
  std::optional<ScipParameters> parameters_;
  ScipEncoding encoding_ = ScipEncoding::kThree;
  bool is_granted_ = false;  ///< the scanner has accepted the request for sweeps
};

}  // namespace orchard::device
