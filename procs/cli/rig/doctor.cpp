// SPDX-License-Identifier: BSD-3-Clause
#include "cli/logs/logs.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "bus/bus.hpp"
#include "bus/node/process_report.hpp"
#include "bus/process/process.hpp"
#include "bus/socket_guard.hpp"
#include "cli/field/field.hpp"
#include "text/encoded_text.hpp"
#include "text/number_text.hpp"
#include "text/parse_number.hpp"

namespace orchard::cli {
namespace {

/// The parts of a udpm URL.
struct UdpmUrl {
  std::string address = "239.255.76.67";
  int port = 7667;
  int ttl = 0;
  std::int64_t recv_buf_size = 0;  ///< 0: the system's default
};

struct NetworkInterface {
  std::string name;
  bool up = false;
  bool loopback = false;
  bool multicast = false;
  bool has_ipv4 = false;
};

template <class Number>
bool read_number(std::string_view text, Number& value) {
  const auto number = parse_number<Number>(text);
  value = number.value_or(value);
  return number.has_value();
}

bool read_option(std::string_view option, UdpmUrl& url) {
  const std::size_t equals = option.find('=');
  if (equals == std::string_view::npos) return false;
  const std::string_view key = option.substr(0, equals);
  const std::string_view value = option.substr(equals + 1);
  if (key == "ttl") return read_number(value, url.ttl);
  if (key == "recv_buf_size") return read_number(value, url.recv_buf_size);
  return true;
}

/// Parses a udpm URL; none unless it is one with a multicast address.
std::optional<UdpmUrl> parse_udpm_url(const std::string& text) {
  constexpr std::string_view kScheme = "udpm://";
  std::string_view rest = text;
  if (rest.substr(0, kScheme.size()) != kScheme) return std::nullopt;
  rest.remove_prefix(kScheme.size());
  UdpmUrl url;
  const std::size_t question = rest.find('?');
  std::string_view network = rest.substr(0, question);
  std::string_view options =
      question == std::string_view::npos ? std::string_view() : rest.substr(question + 1);
  const std::size_t colon = network.find(':');
  if (colon != std::string_view::npos && !read_number(network.substr(colon + 1), url.port)) {
    return std::nullopt;
  }
  network = network.substr(0, colon);
  if (!network.empty()) url.address = std::string(network);
  while (!options.empty()) {
    const std::size_t end = std::min(options.find_first_of("&;"), options.size());
    if (!read_option(options.substr(0, end), url)) return std::nullopt;
    options.remove_prefix(std::min(end + 1, options.size()));
  }
  in_addr address{};
  if (inet_pton(AF_INET, url.address.c_str(), &address) != 1) return std::nullopt;
  if (!IN_MULTICAST(ntohl(address.s_addr)) || url.port < 1 || url.port > 65535) return std::nullopt;
  return url;
}

/// The network interfaces, in the kernel's order.
std::vector<NetworkInterface> network_interfaces() {
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return {};
  const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> owner(list, freeifaddrs);
  std::vector<NetworkInterface> interfaces;
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    auto known = std::find_if(interfaces.begin(), interfaces.end(),
                              [&](const NetworkInterface& i) { return i.name == entry->ifa_name; });
    if (known == interfaces.end()) {
      NetworkInterface interface;
      interface.name = entry->ifa_name;
      known = interfaces.insert(interfaces.end(), interface);
    }
    known->up = (entry->ifa_flags & IFF_UP) != 0;
    known->loopback = (entry->ifa_flags & IFF_LOOPBACK) != 0;
    known->multicast = (entry->ifa_flags & IFF_MULTICAST) != 0;
    if (entry->ifa_addr != nullptr && entry->ifa_addr->sa_family == AF_INET) known->has_ipv4 = true;
  }
  return interfaces;
}

/// The outgoing interface of datagrams to `address`; none without a route.
std::optional<std::string> route_to(const std::string& address) {
  in_addr parsed{};
  if (inet_pton(AF_INET, address.c_str(), &parsed) != 1) return std::nullopt;
  const std::string command = "ip -j route get " + address + " 2>/dev/null";
  const std::unique_ptr<FILE, int (*)(FILE*)> output(popen(command.c_str(), "re"), pclose);
  std::string text;
  for (int c = 0; output && (c = std::fgetc(output.get())) != EOF;) text += static_cast<char>(c);
  const auto routes = nlohmann::json::parse(text, nullptr, false);
  if (!routes.is_array() || routes.empty() || !routes[0].is_object()) return std::nullopt;
  const auto device = routes[0].find("dev");
  if (device == routes[0].end() || !device->is_string()) return std::nullopt;
  return device->get<std::string>();
}

/// Reads a kernel setting by its path below /proc/sys ("net/core/rmem_max"); none when unreadable.
std::optional<std::int64_t> kernel_setting(const std::string& name) {
  std::ifstream file("/proc/sys/" + name);
  std::int64_t value = 0;
  if (!(file >> value)) return std::nullopt;
  return value;
}

/// Tests whether a datagram that is too short for LCM reaches a plain socket of this machine; the
/// guard of config/deploy blocks it. None when the test is impossible.
std::optional<bool> runts_arrive(const UdpmUrl& url) {
  const auto close_it = [](const int* fd) { close(*fd); };
  const int listener = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const int sender = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const std::unique_ptr<const int, decltype(close_it)> a(&listener, close_it);
  const std::unique_ptr<const int, decltype(close_it)> b(&sender, close_it);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(url.port));
  ip_mreq group{};
  if (inet_pton(AF_INET, url.address.c_str(), &group.imr_multiaddr) != 1) return std::nullopt;
  const int yes = 1;
  setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  setsockopt(listener, SOL_SOCKET, SO_REUSEPORT, &yes, sizeof(yes));
  const timeval patience{0, 200000};
  setsockopt(listener, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
  if (bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0 ||
      setsockopt(listener, IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof(group)) != 0) {
    return std::nullopt;
  }
  address.sin_addr = group.imr_multiaddr;
  const unsigned char ttl = 0;
  setsockopt(sender, IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof(ttl));
  // Shorter than LCM's header: every LCM program ignores it.
  const char runt[5] = {'L', 'C', '0', '2', 0};
  if (sendto(sender, runt, sizeof(runt), 0, reinterpret_cast<const sockaddr*>(&address),
             sizeof(address)) != static_cast<ssize_t>(sizeof(runt))) {
    return std::nullopt;
  }
  char bytes[65536];
  for (int i = 0; i < 200; ++i) {  // among datagrams of other senders
    const ssize_t size = recv(listener, bytes, sizeof(bytes), 0);
    if (size < 0) return false;
    if (size == static_cast<ssize_t>(sizeof(runt))) return true;
  }
  return std::nullopt;
}

/// Number of sockets, of any process, bound to the UDP port.
int num_sockets_on_port(int port) {
  std::ifstream file("/proc/net/udp");
  std::string line;
  std::getline(file, line);  // headings
  int count = 0;
  while (std::getline(file, line)) {
    // "sl  local_address rem_address ...": local_address is ADDRESS:PORT in hexadecimal
    std::istringstream words(line);
    std::string slot;
    std::string local;
    words >> slot >> local;
    const std::size_t colon = local.find(':');
    if (colon == std::string::npos) continue;
    count += parse_number<int>(local.substr(colon + 1), 16) == port ? 1 : 0;
  }
  return count;
}

constexpr const char* kOpenFirewall = "sudo iptables -I INPUT -p udp -d 239.0.0.0/8 -j ACCEPT";
/// Min difference that indicates another clock; less can be delay on a busy machine.
constexpr std::int64_t kSkew_us = 150'000;

constexpr const char* kUntilBoot =
    "lasts until the next boot; to keep it, copy config/deploy/60-orchard-lcm.conf to "
    "/etc/sysctl.d";
constexpr const char* kLoadGuard = "sudo nft -f config/deploy/lcm-guard.nft";
constexpr const char* kGuardNote =
    "first set the port and the addresses of the robot in that file (see SECURITY.md)";
constexpr const char* kFirewallNote =
    "allows UDP multicast in the firewall; with ufw: sudo ufw allow in proto udp to 239.0.0.0/8";

enum class Severity { kOk, kWarn, kFail };

struct Finding {
  Severity severity = Severity::kOk;
  std::string text, fix, note;
};

/// Collects findings and their max severity; prints each at once unless JSON is requested.
class Findings {
 public:
  explicit Findings(bool json) : json_(json) {}

  /// `fix`: a command, or instructions; `note`: further explanation.
  void add(Severity severity, const std::string& text, const std::string& fix = {},
           const std::string& note = {}) {
    worst_ = std::max(worst_, severity);
    all_.push_back({severity, text, severity == Severity::kOk ? "" : fix,
                    severity == Severity::kOk ? "" : note});
    if (json_) return;
    constexpr const char* kNames[] = {"OK  ", "WARN", "FAIL"};
    std::printf("%s  %s\n", kNames[static_cast<int>(severity)], text.c_str());
    if (severity != Severity::kOk && !fix.empty()) std::printf("      fix: %s\n", fix.c_str());
    if (severity != Severity::kOk && !note.empty()) std::printf("      note: %s\n", note.c_str());
  }
  void ok(const std::string& text) { add(Severity::kOk, text); }
  void warn(const std::string& text, const std::string& fix = {}, const std::string& note = {}) {
    add(Severity::kWarn, text, fix, note);
  }
  void fail(const std::string& text, const std::string& fix = {}, const std::string& note = {}) {
    add(Severity::kFail, text, fix, note);
  }
  Severity worst() const { return worst_; }

  std::string json(const std::string& lcm_url) const {
    constexpr const char* kNames[] = {"ok", "warn", "fail"};
    nlohmann::ordered_json json{{"lcm_url", lcm_url}, {"worst", kNames[static_cast<int>(worst_)]}};
    json["findings"] = nlohmann::ordered_json::array();
    for (const Finding& finding : all_) {
      nlohmann::ordered_json entry{{"level", kNames[static_cast<int>(finding.severity)]},
                                   {"text", finding.text}};
      if (!finding.fix.empty()) entry["fix"] = finding.fix;
      if (!finding.note.empty()) entry["note"] = finding.note;
      json["findings"].push_back(std::move(entry));
    }
    return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  }

 private:
  bool json_;
  std::vector<Finding> all_;
  Severity worst_ = Severity::kOk;
};

void check_interfaces(Findings& findings, const UdpmUrl& url) {
  const std::vector<NetworkInterface> interfaces = network_interfaces();
  const auto loopback = std::find_if(interfaces.begin(), interfaces.end(),
                                     [](const NetworkInterface& i) { return i.loopback; });
  if (loopback == interfaces.end() || !loopback->up) {
    findings.fail("the loopback interface is down", "sudo ip link set lo up");
  } else {
    findings.ok("the loopback interface is up");
  }
  const std::optional<std::string> route = route_to(url.address);
  if (!route) {
    findings.fail("no route to " + url.address + " (multicast)",
                  "sudo ip link set lo up multicast on && sudo ip route add 224.0.0.0/4 dev lo",
                  "lasts until the next boot; scripts/multicast_lo.sh does the same");
    return;
  }
  findings.ok("multicast to " + url.address + " goes through " + *route);
  const auto is_other = [](const NetworkInterface& i) {
    return i.up && !i.loopback && i.has_ipv4 && i.multicast;
  };
  const auto other = std::find_if(interfaces.begin(), interfaces.end(), is_other);
  const std::string use_other = other == interfaces.end()
                                    ? "use ttl=0 in lcm.url, or bring a network interface up"
                                    : "sudo ip route replace 224.0.0.0/4 dev " + other->name;
  const bool through_loopback = loopback != interfaces.end() && *route == loopback->name;
  if (through_loopback && !loopback->multicast) {
    findings.warn(*route + " has no MULTICAST flag; some LCM programs refuse to use it",
                  "sudo ip link set lo multicast on");
  }
  if (through_loopback && url.ttl > 0) {
    findings.warn("ttl=" + std::to_string(url.ttl) +
                      " in the LCM URL is for several machines, but multicast is routed to " +
                      *route,
                  use_other);
  }
  if (url.ttl > 1) {
    findings.warn("ttl=" + std::to_string(url.ttl) +
                      " in the LCM URL sends messages beyond routers, out of the robot's network",
                  "set ttl=1 in lcm.url");
  }
  const auto num_others = std::count_if(interfaces.begin(), interfaces.end(), is_other);
  if (num_others > 1 && !through_loopback) {
    findings.add(url.ttl > 0 ? Severity::kWarn : Severity::kOk,
                 std::to_string(num_others) + " network interfaces are up; LCM uses only " + *route,
                 "sudo ip route replace 224.0.0.0/4 dev INTERFACE",
                 "replace INTERFACE by the interface of the robot's network");
  }
}

void check_buffers(Findings& findings, const UdpmUrl& url) {
  const std::optional<std::int64_t> limit = kernel_setting("net/core/rmem_max");
  if (!limit) {
    findings.warn("net.core.rmem_max cannot be read: the size of receive buffers is unknown");
    return;
  }
  const std::int64_t wanted = std::max<std::int64_t>(url.recv_buf_size, 2 << 20);
  if (*limit < wanted) {
    findings.warn("receive buffers are limited to " + std::to_string(*limit) + " bytes, but " +
                      std::to_string(wanted) + " are needed: bursts of pictures may be lost",
                  "sudo sysctl -w net.core.rmem_max=" + std::to_string(wanted), kUntilBoot);
  } else {
    findings.ok("receive buffers may be up to " + std::to_string(*limit) + " bytes large");
  }
  if (url.recv_buf_size == 0) {
    findings.warn("the LCM URL sets no receive buffer size",
                  "add recv_buf_size=4194304 to lcm.url");
  }
}

/// Checks the kernel's limits for IP fragments: remains of incomplete pictures must not use up the
/// memory for complete ones.
void check_fragments(Findings& findings, const UdpmUrl& url) {
  constexpr std::int64_t kTimeMax_s = 5;
  constexpr std::int64_t kMemoryMin_bytes = 16 << 20;
  const auto time_s = kernel_setting("net/ipv4/ipfrag_time");
  const auto memory = kernel_setting("net/ipv4/ipfrag_high_thresh");
  if (!time_s || !memory) {
    findings.warn(
        "net.ipv4.ipfrag_time and ipfrag_high_thresh cannot be read: the limits for "
        "message fragments are unknown");
    return;
  }
  const std::string text = "fragments of incomplete messages are kept for " +
                           std::to_string(*time_s) + " s in " + std::to_string(*memory) + " bytes";
  if (*time_s <= kTimeMax_s && *memory >= kMemoryMin_bytes) {
    findings.ok(text);
  } else if (url.ttl == 0) {
    findings.ok(text + "; with ttl=0 messages are not fragmented");
  } else {
    findings.warn(text + ": after lost packets, complete messages may be lost, too",
                  "sudo sysctl -w net.ipv4.ipfrag_time=3 net.ipv4.ipfrag_high_thresh=33554432",
                  kUntilBoot);
  }
}

/// Checks the protection against malformed datagrams, which crash LCM 1.3.1: our programs filter
/// their sockets, others need the firewall.
void check_guard(Findings& findings, const UdpmUrl& url) {
  if (bus::socket_filters_work()) {
    findings.ok("programs of Orchard Mapper drop malformed datagrams that would crash LCM");
  } else {
    findings.warn(
        "this kernel or container does not allow socket filters: malformed datagrams can "
        "crash every LCM program on this machine",
        kLoadGuard, kGuardNote);
  }
  const std::optional<bool> arrive = runts_arrive(url);
  if (!arrive) {
    findings.ok("it could not be tested whether the firewall protects other LCM programs");
  } else if (!*arrive) {
    findings.ok("the firewall protects lcm-logger and lcm-spy from malformed datagrams");
  } else {
    findings.add(
        url.ttl > 0 ? Severity::kWarn : Severity::kOk,
        "malformed datagrams can crash lcm-logger and lcm-spy: the firewall does not block them",
        kLoadGuard, kGuardNote);
  }
}

void check_port(Findings& findings, const UdpmUrl& url) {
  const int num_sockets = num_sockets_on_port(url.port);
  findings.ok(num_sockets == 0 ? "no other program uses UDP port " + std::to_string(url.port)
                               : std::to_string(num_sockets) + " other sockets are on UDP port " +
                                     std::to_string(url.port) + " (LCM programs share it)");
}

/// Sends messages to itself over the network, and listens to other senders meanwhile.
void check_traffic(Findings& findings, const std::string& lcm_url) {
  bus::Bus bus(lcm_url);
  const std::string own_name = "orchard-doctor";
  bool heard_self = false;
  std::map<std::string, std::int64_t> others;  // and their clock offsets [us]
  bus.subscribe_status([&](const bus::Status& status) {
    if (status.name == own_name) {
      heard_self = true;
    } else {
      const std::int64_t offset_us = status.utime - bus::wall_utime();
      std::int64_t& least_us =
          others.emplace(printable_text(status.name + " on " + status.host), offset_us)
              .first->second;
      if (std::llabs(offset_us) < std::llabs(least_us)) least_us = offset_us;
    }
  });
  bus::Status probe;
  probe.name = own_name;
  probe.host = "localhost";
  bool sent = false;
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&start] { return std::chrono::steady_clock::now() - start; };
  while (elapsed() < std::chrono::milliseconds(1300)) {
    if (!heard_self) sent = bus.publish(bus::Channel::kStatus, encode(probe)) || sent;
    ++probe.seq;
    bus.handle(100);
  }
  if (heard_self) {
    findings.ok("a message sent on " + lcm_url + " was received");
  } else {
    findings.fail(
        sent ? "messages sent on " + lcm_url + " are not received: check firewall and route"
             : "messages cannot be sent on " + lcm_url,
        kOpenFirewall, kFirewallNote);
  }
  std::string names;
  for (const auto& [name, offset_us] : others) names += (names.empty() ? "" : ", ") + name;
  findings.ok(others.empty() ? "no process of Orchard Mapper is running on this network"
                             : "running processes: " + names);
  for (const auto& [name, offset_us] : others) {
    if (std::llabs(offset_us) < kSkew_us) continue;
    findings.warn("the clock of " + name + " is " +
                      fixed_text(1e-6 * static_cast<double>(std::llabs(offset_us)), 1) + " s " +
                      (offset_us > 0 ? "ahead of" : "behind") + " this machine's",
                  "sudo systemctl restart chrony",
                  "how to synchronise all machines: config/deploy");
  }
  if (bus.counts().num_bad() > 0) {
    findings.warn(std::to_string(bus.counts().num_bad()) +
                      " messages on this network are invalid or not of Orchard Mapper",
                  "set a separate port for this robot in lcm.url");
  }
}

}  // namespace

int run_doctor(const DoctorOptions& options) {
  const std::string lcm_url = field_url(options);
  const std::optional<UdpmUrl> url = parse_udpm_url(bus::parse_network(lcm_url).lcm_url);
  if (!url) {
    std::fprintf(stderr,
                 "orchard doctor: \"%s\" is not an LCM URL; give one such as "
                 "udpm://239.255.76.67:7667?ttl=0\n",
                 printable_text(lcm_url).c_str());
    return bus::kExitUsage;
  }
  if (!options.json) std::printf("LCM URL: %s\n", lcm_url.c_str());
  Findings findings(options.json);
  check_interfaces(findings, *url);
  check_buffers(findings, *url);
  check_fragments(findings, *url);
  check_port(findings, *url);
  if (findings.worst() != Severity::kFail) {
    try {
      check_guard(findings, *url);
      check_traffic(findings, lcm_url);
    } catch (const std::exception& error) {
      findings.fail(error.what(), kOpenFirewall, kFirewallNote);
    }
  }
  constexpr const char* kResults[] = {"all is well", "usable, with warnings",
                                      "LCM cannot work yet"};
  if (options.json) {
    std::fputs(findings.json(lcm_url).c_str(), stdout);
  } else {
    std::printf("%s\n", kResults[static_cast<int>(findings.worst())]);
  }
  return findings.worst() == Severity::kFail ? bus::kExitRuntime : bus::kExitOk;
}

}  // namespace orchard::cli
