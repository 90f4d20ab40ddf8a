// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace orchard::bus {

/// A network as the command line names it; empty: not given.
struct NetworkOptions {
  std::string lcm_url;
  std::string robot;  ///< replaces the robot of the URL
};

/// An LCM network, and the robot whose channels are used on it.
struct Network {
  std::string lcm_url;  ///< as LCM understands it
  std::string robot;    ///< empty: channels without a robot's name
};

/// True for 1 to 32 letters, digits, - and _, so that the name fits before a channel of LCM.
bool is_robot_name(std::string_view text);

/// Separates the parameter `robot=NAME`, which LCM does not know, from a URL. Throws
/// std::invalid_argument for a bad name and for two of them.
Network parse_network(const std::string& url);

/// The name of a channel on the wire, "koala/SCAN", in its parts.
struct RobotChannel {
  std::string_view robot;  ///< empty: none
  std::string_view name;
};

/// Separates the robot from a known channel; other names are returned whole.
RobotChannel split_robot(std::string_view wire_name);

/// Throws io::FileError if a log's channel carries a robot's name: what reads a log reads one
/// robot's.
void require_no_robot(std::string_view wire_name, const std::string& log_path);

/// The URL with its robot replaced; `robot` empty: unchanged.
std::string with_robot(const std::string& url, const std::string& robot);

}  // namespace orchard::bus
