// SPDX-License-Identifier: BSD-3-Clause
#include "bus/network.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "bus/messages/channel.hpp"
#include "io/file_error.hpp"

namespace orchard::bus {
namespace {

constexpr std::string_view kRobotKey = "robot=";

/// derived: LCM's limit of 63 characters, less the longest name of a channel and room for others.
constexpr std::size_t kRobotNameMax = 32;

bool is_robot(const std::string& parameter) {
  return parameter.compare(0, kRobotKey.size(), kRobotKey) == 0;
}

/// The parameters of a URL, each with the sign before it.
std::vector<std::string> parameters_of(const std::string& url) {
  std::vector<std::string> parameters;
  for (std::size_t at = url.find('?'); at != std::string::npos;) {
    const std::size_t next = url.find_first_of("&;", at + 1);
    parameters.push_back(url.substr(at + 1, next - at - 1));
    at = next;
  }
  return parameters;
}

std::string joined(std::string url, const std::vector<std::string>& parameters) {
  char sign = '?';
  for (const std::string& parameter : parameters) {
    url += sign + parameter;
    sign = '&';
  }
  return url;
}

}  // namespace

bool is_robot_name(std::string_view text) {
  return !text.empty() && text.size() <= kRobotNameMax &&
         text.find_first_not_of(
             "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_") ==
             std::string_view::npos;
}

Network parse_network(const std::string& url) {
  std::vector<std::string> parameters = parameters_of(url);
  const auto others = std::stable_partition(parameters.begin(), parameters.end(), is_robot);
  if (others == parameters.begin()) return {url, {}};
  const std::string robot = parameters.front().substr(kRobotKey.size());
  if (others - parameters.begin() > 1 || !is_robot_name(robot)) {
    throw std::invalid_argument("LCM URL \"" + url +
                                "\": robot= must be one name of 1 to 32 letters, digits, - or _");
  }
  parameters.erase(parameters.begin(), others);
  return {joined(url.substr(0, url.find('?')), parameters), robot};
}

RobotChannel split_robot(std::string_view wire_name) {
  const std::size_t slash = std::min(wire_name.find('/'), wire_name.size());
  const std::string_view robot = wire_name.substr(0, slash);
  const std::string_view name = wire_name.substr(std::min(slash + 1, wire_name.size()));
  if (!is_robot_name(robot) || !find_channel(name)) return {{}, wire_name};
  return {robot, name};
}

void require_no_robot(std::string_view wire_name, const std::string& log_path) {
  const RobotChannel channel = split_robot(wire_name);
  if (channel.robot.empty()) return;
  throw io::FileError(log_path + ": holds messages of the robot " + std::string(channel.robot) +
                      " (" + std::string(wire_name) +
                      "), and perhaps of others; write a log for each robot with \"orchard log "
                      "split\"");
}

std::string with_robot(const std::string& url, const std::string& robot) {
  if (robot.empty()) return url;
  std::vector<std::string> parameters = parameters_of(url);
  parameters.erase(std::remove_if(parameters.begin(), parameters.end(), is_robot),
                   parameters.end());
  parameters.push_back(std::string(kRobotKey) + robot);
  return joined(url.substr(0, url.find('?')), parameters);
}

}  // namespace orchard::bus
