// SPDX-License-Identifier: BSD-3-Clause
#include "bus/bus.hpp"

#include <lcm/lcm.h>
#include <poll.h>
#include <spdlog/spdlog.h>

#include <cerrno>
#include <chrono>
#include <exception>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "bus/network.hpp"
#include "bus/socket_guard.hpp"

namespace orchard::bus {
namespace {

/// Logs rejected messages, at most one line per channel and reason in five seconds, so that a flood
/// of bad datagrams does not flood the log.
class RejectionLog {
 public:
  void note(Channel channel, const Rejection& rejection) {
    const auto index = static_cast<std::size_t>(channel) * kNumReasons +
                       static_cast<std::size_t>(rejection.reason);
    Entry& entry = entries_[index];
    const auto now = std::chrono::steady_clock::now();
    if (entry.used && now - entry.last < std::chrono::seconds(5)) {
      ++entry.num_silent;
      return;
    }
    spdlog::warn(
        "{}: refused an invalid message ({}: {}); {} more of this kind since the last report",
        info(channel).name, to_string(rejection.reason), rejection.detail, entry.num_silent);
    entry = {now, 0, true};
  }

 private:
  struct Entry {
    std::chrono::steady_clock::time_point last{};
    std::int64_t num_silent = 0;
    bool used = false;
  };
  std::array<Entry, kNumChannels * kNumReasons> entries_;
};

}  // namespace

std::int64_t BusCounts::num_bad() const {
  return std::accumulate(num_rejected.begin(), num_rejected.end(), std::int64_t{0});
}

struct Bus::Impl {
  /// Context of an LCM callback: the subscribed channel and the function that receives the bytes.
  struct Subscription {
    Impl* bus;
    Channel channel;
    std::function<std::variant<std::monostate, Rejection>(Bytes)> receive;
  };

  std::string url;
  std::string robot;                            // empty: none
  std::array<std::string, kNumChannels> names;  // of the channels on the wire
  std::optional<SocketGuard> guard;
  std::vector<std::string> heard;  // names of the subscribed channels
  bool hears_all = false;
  lcm_t* lcm = nullptr;
  std::vector<std::unique_ptr<Subscription>> subscriptions;
  std::function<void(Channel, const Rejection&)> rejection_handler;
  std::function<void(const std::string&, std::int64_t, Bytes)> raw_handler;
  RejectionLog rejection_log;
  BusCounts counts;
  std::exception_ptr pending;

  ~Impl() {
    if (lcm != nullptr) lcm_destroy(lcm);
  }

  void name_channels(const std::string& its_robot) {
    robot = its_robot;
    for (const ChannelInfo& channel : kChannels) {
      names[static_cast<std::size_t>(channel.channel)] =
          (robot.empty() ? "" : robot + "/") + std::string(channel.name);
    }
  }

  const std::string& name_of(Channel channel) const {
    return names[static_cast<std::size_t>(channel)];
  }

  bool is_private() const { return url.compare(0, 7, "memq://") == 0; }

  static bool has_failed(const lcm_subscription_t* subscription) { return subscription == nullptr; }
  static bool has_failed(int fd) { return fd < 0; }

  /// Runs `open` and guards the socket it opens: LCM opens its receiving socket with the first
  /// subscription or the first call of lcm_get_fileno().
  template <class Open>
  auto open_guarded(Open open) {
    if (guard || is_private()) return open();
    guard.emplace();  // records the sockets that exist before
    const auto opened = open();
    if (has_failed(opened)) {
      guard.reset();
      return opened;
    }
    if (guard->attach() == 0) {
      spdlog::warn(
          "the socket of {} has no filter: malformed datagrams can crash this process (see "
          "SECURITY.md)",
          url);
    }
    listen_to_subscribed();
    return opened;
  }

  /// Filters out the channels that this process does not read: images alone are most of the
  /// traffic.
  void listen_to_subscribed() {
    if (guard && !hears_all) guard->listen_to(heard);
  }

  /// LCM's C frames are on the stack: no exception may leave this function.
  static void on_message(const lcm_recv_buf_t* buffer, const char*, void* context) {
    auto* subscription = static_cast<Subscription*>(context);
    Impl& bus = *subscription->bus;
    try {
      const Bytes bytes{static_cast<const std::uint8_t*>(buffer->data), buffer->data_size};
      const auto result = subscription->receive(bytes);
      if (const auto* rejection = std::get_if<Rejection>(&result)) {
        bus.refuse(subscription->channel, *rejection);
      }
    } catch (...) {
      if (!bus.pending) bus.pending = std::current_exception();
    }
  }

  static void on_raw_message(const lcm_recv_buf_t* buffer, const char* channel, void* context) {
    Impl& bus = *static_cast<Impl*>(context);
    try {
      const Bytes bytes{static_cast<const std::uint8_t*>(buffer->data), buffer->data_size};
      bus.handle_raw(channel, buffer->recv_utime, bytes);
    } catch (...) {
      if (!bus.pending) bus.pending = std::current_exception();
    }
  }

  /// Without a robot of its own a recorder takes the names as they are, those of all robots.
  void handle_raw(const std::string& name, std::int64_t receipt_utime, Bytes bytes) {
    if (robot.empty()) return raw_handler(name, receipt_utime, bytes);
    const RobotChannel channel = split_robot(name);
    if (channel.robot != robot && find_channel(channel.name)) return;
    raw_handler(std::string(channel.name), receipt_utime, bytes);
  }

  void subscribe_raw(std::function<void(const std::string&, std::int64_t, Bytes)> handler) {
    if (guard) throw BusError("subscribe_raw must be the first subscription");
    raw_handler = std::move(handler);
    hears_all = true;
    open_subscription(".*", &Impl::on_raw_message, this, kLargeQueue);
  }

  /// `pattern`: a regular expression, as LCM expects. `capacity`: max number of waiting messages.
  void open_subscription(const std::string& pattern, lcm_msg_handler_t handler, void* context,
                         int capacity) {
    lcm_subscription_t* subscription =
        open_guarded([&] { return lcm_subscribe(lcm, pattern.c_str(), handler, context); });
    if (subscription == nullptr) {
      throw BusError("cannot subscribe to messages on " + url +
                     ": check the multicast route and the firewall with \"orchard doctor\"");
    }
    lcm_subscription_set_queue_capacity(subscription, is_private() ? 0 : capacity);
  }

  void refuse(Channel channel, const Rejection& rejection) {
    ++counts.num_rejected[static_cast<std::size_t>(rejection.reason)];
    rejection_log.note(channel, rejection);
    if (rejection_handler) rejection_handler(channel, rejection);
  }

  /// Subscribes with `decode` before `handle`; every subscription except the raw one goes through
  /// here.
  template <class Decode, class Handle>
  void subscribe(Channel channel, Decode decode, Handle handle) {
    auto subscription = std::make_unique<Subscription>();
    subscription->bus = this;
    subscription->channel = channel;
    subscription->receive = [this, decode,
                             handle](Bytes bytes) -> std::variant<std::monostate, Rejection> {
      auto decoded = decode(bytes.data, bytes.size);
      if (auto* rejection = std::get_if<Rejection>(&decoded)) return std::move(*rejection);
      ++counts.num_good;
      handle(std::get<0>(std::move(decoded)), bytes);
      return {};
    };
    std::string name;  // LCM takes a regular expression, so dots are escaped
    for (const char c : name_of(channel)) name += c == '.' ? std::string("\\.") : std::string(1, c);
    heard.push_back(name_of(channel));
    listen_to_subscribed();
    open_subscription(name, &Impl::on_message, subscription.get(),
                      channel == Channel::kImage ? kImageQueue : kInputQueue);
    subscriptions.push_back(std::move(subscription));
  }
};

Bus::Bus(const std::string& url) : impl_(std::make_unique<Impl>()) {
  impl_->url = url;
  if (url.compare(0, 7, "udpm://") != 0 && url.compare(0, 7, "memq://") != 0) {
    throw BusError("LCM URL \"" + url +
                   "\": must begin with udpm://; to replay a log use orchard-log-player");
  }
  Network network;
  try {
    network = parse_network(url);
  } catch (const std::invalid_argument& error) {
    throw BusError(error.what());
  }
  impl_->name_channels(network.robot);
  impl_->lcm = lcm_create(network.lcm_url.c_str());
  if (impl_->lcm == nullptr) {
    throw BusError("LCM cannot use " + url +
                   ": check its address and port, and the multicast route with \"orchard doctor\" "
                   "(on a machine without network: \"ip route add 224.0.0.0/4 dev lo\")");
  }
}

Bus::~Bus() = default;

void Bus::subscribe(Channel channel, std::function<void(Message&&, Bytes)> handler) {
  impl_->subscribe(
      channel,
      [channel](const void* data, std::size_t size) { return decode(channel, data, size); },
      std::move(handler));
}

void Bus::subscribe_status(std::function<void(const Status&)> handler) {
  impl_->subscribe(Channel::kStatus, decode_status,
                   [handler = std::move(handler)](const Status& m, Bytes) { handler(m); });
}

void Bus::subscribe_config(std::function<void(const ConfigNotice&)> handler) {
  impl_->subscribe(Channel::kConfig, decode_config,
                   [handler = std::move(handler)](const ConfigNotice& m, Bytes) { handler(m); });
}

void Bus::subscribe_ack(std::function<void(const Ack&)> handler) {
  impl_->subscribe(Channel::kAck, decode_ack,
                   [handler = std::move(handler)](const Ack& m, Bytes) { handler(m); });
}

void Bus::subscribe_replay(std::function<void(const ReplayMark&)> handler) {
  impl_->subscribe(Channel::kReplay, decode_replay,
                   [handler = std::move(handler)](const ReplayMark& m, Bytes) { handler(m); });
}

void Bus::subscribe_raw(std::function<void(const std::string&, std::int64_t, Bytes)> handler) {
  impl_->subscribe_raw(std::move(handler));
}

void Bus::on_rejection(std::function<void(Channel, const Rejection&)> handler) {
  impl_->rejection_handler = std::move(handler);
}

bool Bus::publish(Channel channel, const std::vector<std::uint8_t>& bytes) {
  if (bytes.size() > std::numeric_limits<unsigned>::max()) return false;
  const int result = lcm_publish(impl_->lcm, impl_->name_of(channel).c_str(), bytes.data(),
                                 static_cast<unsigned>(bytes.size()));
  ++(result == 0 ? impl_->counts.num_published : impl_->counts.num_unsent);
  return result == 0;
}

bool Bus::publish(const Message& message) { return publish(channel_of(message), encode(message)); }

int Bus::fileno() const {
  return impl_->open_guarded([this] { return lcm_get_fileno(impl_->lcm); });
}

bool Bus::handle(int timeout_ms) {
  pollfd waiting{fileno(), POLLIN, 0};
  const int ready = poll(&waiting, 1, timeout_ms);
  if (ready == 0 || (ready < 0 && errno == EINTR)) return false;
  errno = 0;
  const int result = ready < 0 ? -1 : lcm_handle(impl_->lcm);
  if (impl_->pending) std::rethrow_exception(std::exchange(impl_->pending, nullptr));
  if (result < 0) {
    if (errno == EINTR) return false;
    throw BusError("receiving from LCM failed on " + impl_->url);
  }
  return true;
}

const BusCounts& Bus::counts() const { return impl_->counts; }

std::int64_t Bus::num_dropped() const {
  return impl_->hears_all && impl_->guard ? impl_->guard->num_dropped() : 0;
}

const std::string& Bus::url() const { return impl_->url; }

}  // namespace orchard::bus
