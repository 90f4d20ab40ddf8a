// SPDX-License-Identifier: BSD-3-Clause
#include "cli/rig/doctor.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "bus/bus.hpp"
#include "bus/node/process.hpp"
#include "cli/rig/network_facts.hpp"

namespace orchard::cli {
namespace {

constexpr const char* kOpenFirewall = "sudo iptables -I INPUT -p udp -d 239.0.0.0/8 -j ACCEPT";
constexpr const char* kFirewallNote =
    "lets UDP multicast through the firewall; with ufw: sudo ufw allow in proto udp to 239.0.0.0/8";

enum class Verdict { kOk, kWarn, kFail };

struct Finding {
  Verdict verdict = Verdict::kOk;
  std::string text, fix, note;
};

/// Remembers findings and the worst of them, and prints each at once unless all are wanted as JSON.
class Findings {
 public:
  explicit Findings(bool json) : json_(json) {}

  /// `fix` is a command to type (or else says so in words); `note` says more.
  void add(Verdict verdict, const std::string& text, const std::string& fix = {},
           const std::string& note = {}) {
    worst_ = std::max(worst_, verdict);
    all_.push_back(
        {verdict, text, verdict == Verdict::kOk ? "" : fix, verdict == Verdict::kOk ? "" : note});
    if (json_) return;
    constexpr const char* kNames[] = {"OK  ", "WARN", "FAIL"};
    std::printf("%s  %s\n", kNames[static_cast<int>(verdict)], text.c_str());
    if (verdict != Verdict::kOk && !fix.empty()) std::printf("      fix: %s\n", fix.c_str());
    if (verdict != Verdict::kOk && !note.empty()) std::printf("      note: %s\n", note.c_str());
  }
  Verdict worst() const { return worst_; }

  std::string json(const std::string& lcm_url) const {
    constexpr const char* kNames[] = {"ok", "warn", "fail"};
    nlohmann::ordered_json json{{"lcm_url", lcm_url}, {"worst", kNames[static_cast<int>(worst_)]}};
    json["findings"] = nlohmann::ordered_json::array();
    for (const Finding& finding : all_) {
      nlohmann::ordered_json entry{{"level", kNames[static_cast<int>(finding.verdict)]},
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
  Verdict worst_ = Verdict::kOk;
};

void check_interfaces(Findings& findings, const UdpmUrl& url) {
  const std::vector<NetworkInterface> interfaces = network_interfaces();
  const auto loopback = std::find_if(interfaces.begin(), interfaces.end(),
                                     [](const NetworkInterface& i) { return i.loopback; });
  if (loopback == interfaces.end() || !loopback->up) {
    findings.add(Verdict::kFail, "the loopback interface is down", "sudo ip link set lo up");
  } else {
    findings.add(Verdict::kOk, "the loopback interface is up");
  }
  const std::optional<std::string> route = route_to(url.address);
  if (!route) {
    findings.add(Verdict::kFail, "no route to " + url.address + " (multicast)",
                 "sudo ip link set lo up multicast on && sudo ip route add 224.0.0.0/4 dev lo",
                 "until the next boot; scripts/multicast_lo.sh does the same");
    return;
  }
  findings.add(Verdict::kOk, "multicast to " + url.address + " goes through " + *route);
  const auto is_other = [](const NetworkInterface& i) {
    return i.up && !i.loopback && i.has_ipv4 && i.multicast;
  };
  const auto other = std::find_if(interfaces.begin(), interfaces.end(), is_other);
  const std::string use_other = other == interfaces.end()
                                    ? "use ttl=0 in lcm.url, or bring a network interface up"
                                    : "sudo ip route replace 224.0.0.0/4 dev " + other->name;
  const bool through_loopback = loopback != interfaces.end() && *route == loopback->name;
  if (through_loopback && !loopback->multicast) {
    findings.add(Verdict::kWarn, *route + " has no MULTICAST flag; some programs refuse it",
                 "sudo ip link set lo multicast on");
  }
  if (through_loopback && url.ttl > 0) {
    findings.add(Verdict::kWarn,
                 "ttl=" + std::to_string(url.ttl) +
                     " asks for other machines, but multicast stays on " + *route,
                 use_other);
  }
  if (url.ttl > 1) {
    findings.add(Verdict::kWarn, "ttl=" + std::to_string(url.ttl) + " crosses routers",
                 "use ttl=1 for the robot's own network");
  }
  const auto num_others = std::count_if(interfaces.begin(), interfaces.end(), is_other);
  if (num_others > 1 && !through_loopback) {
    findings.add(url.ttl > 0 ? Verdict::kWarn : Verdict::kOk,
                 std::to_string(num_others) + " network interfaces are up; LCM uses only " + *route,
                 "sudo ip route replace 224.0.0.0/4 dev INTERFACE", "INTERFACE: the one to use");
  }
}

void check_buffers(Findings& findings, const UdpmUrl& url) {
  const std::optional<std::int64_t> limit = receive_buffer_limit();
  if (!limit) {
    findings.add(Verdict::kWarn, "net.core.rmem_max cannot be read here");
    return;
  }
  const std::int64_t wanted = std::max<std::int64_t>(url.recv_buf_size, 2 << 20);
  if (*limit < wanted) {
    findings.add(Verdict::kWarn,
                 "receive buffers are limited to " + std::to_string(*limit) + " bytes, wanted " +
                     std::to_string(wanted) + ": bursts of pictures may be lost",
                 "sudo sysctl -w net.core.rmem_max=" + std::to_string(wanted),
                 "until the next boot; a line net.core.rmem_max=" + std::to_string(wanted) +
                     " in /etc/sysctl.d/60-lcm.conf keeps it");
  } else {
    findings.add(Verdict::kOk, "receive buffers may have " + std::to_string(*limit) + " bytes");
  }
  if (url.recv_buf_size == 0) {
    findings.add(Verdict::kWarn, "the URL asks for no receive buffer",
                 "add recv_buf_size=4194304 to lcm.url");
  }
}

void check_port(Findings& findings, const UdpmUrl& url) {
  const int num_sockets = num_sockets_on_port(url.port);
  findings.add(Verdict::kOk, num_sockets == 0
                                 ? "no other program uses UDP port " + std::to_string(url.port)
                                 : std::to_string(num_sockets) + " other sockets are on UDP port " +
                                       std::to_string(url.port) + " (LCM programs share it)");
}

/// Sends to itself through the real network path, and listens to what others send meanwhile.
void check_traffic(Findings& findings, const std::string& lcm_url) {
  bus::Bus bus(lcm_url);
  const std::string own_name = "orchard-doctor";
  bool heard_self = false;
  std::set<std::string> others;
  bus.subscribe_status([&](const bus::Status& status) {
    if (status.name == own_name) {
      heard_self = true;
    } else {
      others.insert(status.name);
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
    findings.add(Verdict::kOk, "a message sent on " + lcm_url + " came back");
  } else {
    findings.add(Verdict::kFail,
                 sent ? "messages sent on " + lcm_url + " do not come back"
                      : "the network refuses what is sent on " + lcm_url,
                 kOpenFirewall, kFirewallNote);
  }
  std::string names;
  for (const std::string& name : others) names += (names.empty() ? "" : ", ") + name;
  findings.add(Verdict::kOk, others.empty() ? "no Orchard Mapper process is running on it"
                                            : "running on it: " + names);
  if (bus.counts().num_bad() > 0) {
    findings.add(Verdict::kWarn,
                 std::to_string(bus.counts().num_bad()) + " messages there are not ours or broken",
                 "give this system a port of its own in lcm.url");
  }
}

}  // namespace

int run_doctor(const DoctorOptions& options) {
  const std::optional<UdpmUrl> url = parse_udpm_url(options.lcm_url);
  if (!url) {
    std::fprintf(stderr,
                 "orchard doctor: \"%s\" is no URL such as udpm://239.255.76.67:7667?ttl=0\n",
                 options.lcm_url.c_str());
    return bus::kExitUsage;
  }
  if (!options.json) std::printf("LCM URL: %s\n", options.lcm_url.c_str());
  Findings findings(options.json);
  check_interfaces(findings, *url);
  check_buffers(findings, *url);
  check_port(findings, *url);
  if (findings.worst() != Verdict::kFail) {
    try {
      check_traffic(findings, options.lcm_url);
    } catch (const std::exception& error) {
      findings.add(Verdict::kFail, error.what(), kOpenFirewall, kFirewallNote);
    }
  }
  constexpr const char* kResults[] = {"all is well", "usable, with warnings",
                                      "LCM cannot work yet"};
  if (options.json) {
    std::fputs(findings.json(options.lcm_url).c_str(), stdout);
  } else {
    std::printf("%s\n", kResults[static_cast<int>(findings.worst())]);
  }
  return findings.worst() == Verdict::kFail ? bus::kExitRuntime : bus::kExitOk;
}

}  // namespace orchard::cli
