// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "bus/messages/codec.hpp"
#include "bus/messages/service_messages.hpp"

namespace orchard::bus {

/// The network cannot be used as the URL says; the message says why and what to do.
class BusError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A message's bytes as they came, valid during the handler only.
struct Bytes {
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;
};

/// What the guard let through and refused.
struct BusCounts {
  std::int64_t num_good = 0;
  std::int64_t num_published = 0;
  std::int64_t num_unsent = 0;  ///< the network refused them
  std::array<std::int64_t, kNumReasons> num_rejected{};
  std::int64_t num_bad() const;
};

/// One LCM instance behind the guard: everything that arrives goes through decode before any
/// handler sees it, and what is refused is counted by reason and logged at a limited rate.
///
/// One thread only. Handlers may publish, and may throw: handle() lets the exception out once
/// LCM's own frames are gone.
class Bus {
 public:
  /// Opens a "udpm://..." or "memq://" URL. Throws BusError with a hint.
  explicit Bus(const std::string& url);
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  /// Longest queue of a subscription in messages; beyond it LCM drops what arrives.
  static constexpr int kLargeQueue = 20000;  ///< of a recorder
  static constexpr int kInputQueue = 2000;
  static constexpr int kImageQueue = 64;

  /// Several subscriptions to a channel are handled in the order in which they were made. Throws
  /// BusError when nothing can be received (LCM's self test failed).
  void subscribe(Channel channel, std::function<void(const Message&, Bytes)> handler);
  void subscribe_status(std::function<void(const Status&)> handler);
  void subscribe_config(std::function<void(const ConfigNotice&)> handler);
  void subscribe_ack(std::function<void(const Ack&)> handler);
  void subscribe_replay(std::function<void(const ReplayMark&)> handler);

  /// Every message of every channel, known or not, as it came and unchecked: for recorders alone,
  /// before anything else is subscribed to (BusError).
  /// `receipt_utime`: host's time of day when the network gave it to LCM [us].
  void subscribe_raw(
      std::function<void(const std::string& channel, std::int64_t receipt_utime, Bytes)> handler);

  /// Called for each refused message besides counting and logging it. May throw.
  void on_rejection(std::function<void(Channel, const Rejection&)> handler);

  /// Sends; false (and counted) when the network refuses.
  bool publish(Channel channel, const std::vector<std::uint8_t>& bytes);
  bool publish(const Message& message);

  /// Becomes readable when a message waits.
  int fileno() const;

  /// Handles one message, waiting for it at most `timeout_ms`. False when none came, also when a
  /// signal cut the waiting short. Throws what a handler threw, and BusError.
  bool handle(int timeout_ms);

  const BusCounts& counts() const;
  /// Datagrams that the kernel kept from one who hears everything: crafted to end it (SocketGuard),
  /// or more than the receive buffer holds. Of others the kernel counts what they do not want, too:
  /// 0.
  std::int64_t num_dropped() const;
  const std::string& url() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace orchard::bus
