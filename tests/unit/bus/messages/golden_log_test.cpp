// SPDX-License-Identifier: BSD-3-Clause
// Logs of every release must stay readable: see tests/data/README.md.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "bus/messages/codec.hpp"
#include "bus/messages/service_messages.hpp"
#include "io/log/log_reader.hpp"

namespace orchard::bus {
namespace {

/// Channels of the first release; what came later has a log of its own.
constexpr std::size_t kNumFirstChannels = 12;

/// Decoded values by name, as text with every digit.
class Values {
 public:
  template <class Number>
  void put(const std::string& name, Number value) {
    std::ostringstream text;
    text.precision(17);
    text << +value;
    texts_[name] = text.str();
  }
  void put(const std::string& name, const std::string& value) { texts_[name] = value; }
  void count(const std::string& channel) { put(channel + ".count", ++counts_[channel]); }
  const std::map<std::string, std::string>& texts() const { return texts_; }

 private:
  std::map<std::string, std::string> texts_;
  std::map<std::string, int> counts_;
};

void put(Values& v, const laser::Scan& m) {
  v.put("SCAN.bearing_min_rad", m.bearing_min_rad);
  v.put("SCAN.bearing_step_rad", m.bearing_step_rad);
  v.put("SCAN.beam_period_us", m.beam_period_us);
  v.put("SCAN.range_min_m", m.range_min_m);
  v.put("SCAN.range_max_m", m.range_max_m);
  v.put("SCAN.num_ranges", m.ranges_m.size());
  v.put("SCAN.ranges_m[3]", m.ranges_m.at(3));
  v.put("SCAN.num_intensities", m.intensities.size());
  if (!m.intensities.empty()) v.put("SCAN.intensities[2]", m.intensities.at(2));
}

void put(Values& v, const vision::Image& m) {
  v.put("IMAGE.width_px", m.width_px);
  v.put("IMAGE.height_px", m.height_px);
  v.put("IMAGE.encoding", static_cast<int>(m.encoding));
  v.put("IMAGE.num_bytes", m.data.size());
  v.put("IMAGE.data[9]", m.data.at(9));
}

void put(Values& v, const pose::Odometry& m) {
  v.put("ODOMETRY.speed_mps", m.speed_mps);
  v.put("ODOMETRY.yaw_rate_radps", m.yaw_rate_radps);
  v.put("ODOMETRY.covariance[2]", m.covariance[2]);
}

void put(Values& v, const pose::Gnss& m) {
  v.put("GNSS.latitude_deg", m.latitude_deg);
  v.put("GNSS.longitude_deg", m.longitude_deg);
  v.put("GNSS.altitude_m", m.altitude_m);
  v.put("GNSS.covariance[4]", m.covariance[4]);
  v.put("GNSS.fix_quality", m.fix_quality);
}

void put(Values& v, const pose::PoseFix& m) {
  v.put("POSE_FIX.x_m", m.x_m);
  v.put("POSE_FIX.y_m", m.y_m);
  v.put("POSE_FIX.yaw_rad", m.yaw_rad);
  v.put("POSE_FIX.covariance[5]", m.covariance[5]);
  v.put("POSE_FIX.has_yaw", m.has_yaw);
}

void put(Values& v, const pose::PoseEstimate& m) {
  v.put("POSE.x_m", m.x_m);
  v.put("POSE.y_m", m.y_m);
  v.put("POSE.yaw_rad", m.yaw_rad);
  v.put("POSE.pitch_rad", m.pitch_rad);
  v.put("POSE.roll_rad", m.roll_rad);
  v.put("POSE.covariance[1]", m.covariance[1]);
}

void put(Values& v, const detection::Detections& m) {
  v.put("DETECTIONS.image_utime", m.image_utime);
  v.put("DETECTIONS.num_trunks", m.trunks.size());
  const detection::Detection& trunk = m.trunks.at(0);
  const std::string name = "DETECTIONS.trunk.";
  v.put(name + "utime", trunk.utime);
  v.put(name + "range_m", trunk.range_m);
  v.put(name + "bearing_rad", trunk.bearing_rad);
  v.put(name + "surface_x_m", trunk.surface_x_m);
  v.put(name + "surface_y_m", trunk.surface_y_m);
  v.put(name + "centre_x_m", trunk.centre_x_m);
  v.put(name + "centre_y_m", trunk.centre_y_m);
  v.put(name + "covariance[1]", trunk.covariance[1]);
  v.put(name + "width_m", trunk.width_m);
  v.put(name + "width_sd_m", trunk.width_sd_m);
  v.put(name + "roc_laser", trunk.roc_laser);
  v.put(name + "roc_colour", trunk.roc_colour);
  v.put(name + "roc_left_edge", trunk.roc_left_edge);
  v.put(name + "roc_right_edge", trunk.roc_right_edge);
  v.put(name + "roc_parallel", trunk.roc_parallel);
  v.put(name + "roc_edges", trunk.roc_edges);
  v.put(name + "roc_vision", trunk.roc_vision);
  v.put(name + "roc_tree", trunk.roc_tree);
  v.put(name + "probability_tree", trunk.probability_tree);
  v.put(name + "probability_object", trunk.probability_object);
  v.put(name + "intensity", trunk.intensity);
  v.put(name + "num_beams", trunk.num_beams);
  v.put(name + "label", static_cast<int>(trunk.label));
  v.put(name + "occlusion", static_cast<int>(trunk.occlusion));
}

void put(Values& v, const mapping::MapTile& m) {
  v.put("MAP.num_landmarks_total", m.num_landmarks_total);
  v.put("MAP.num_landmarks", m.landmarks.size());
  v.put("MAP.num_removed", m.removed_ids.size());
  v.put("MAP.removed_ids[1]", m.removed_ids.at(1));
  const mapping::Landmark& landmark = m.landmarks.at(0);
  const std::string name = "MAP.landmark.";
  v.put(name + "id", landmark.id);
  v.put(name + "label", static_cast<int>(landmark.label));
  v.put(name + "num_observations", landmark.num_observations);
  v.put(name + "x_m", landmark.x_m);
  v.put(name + "y_m", landmark.y_m);
  v.put(name + "se_x_m", landmark.se_x_m);
  v.put(name + "se_y_m", landmark.se_y_m);
  v.put(name + "covariance[2]", landmark.covariance[2]);
  v.put(name + "width_m", landmark.width_m);
  v.put(name + "roc_mean", landmark.roc_mean);
  v.put(name + "probability", landmark.probability);
  v.put(name + "row", landmark.row);
  v.put(name + "position", landmark.position);
}

void put(Values& v, const detection::AdaptationStep& m) {
  v.put("ADAPTATION.action", static_cast<int>(m.action));
  v.put("ADAPTATION.reason", static_cast<int>(m.reason));
  v.put("ADAPTATION.num_width_trees", m.num_width_trees);
  v.put("ADAPTATION.num_colour_trees", m.num_colour_trees);
  v.put("ADAPTATION.confident_share", m.confident_share);
  v.put("ADAPTATION.width_mean_m", m.model.width_mean_m);
  v.put("ADAPTATION.light_blue", m.model.light.blue);
  v.put("ADAPTATION.light_red", m.model.light.red);
  v.put("ADAPTATION.light_green", m.model.light.green);
}

void put(Values& v, const pose::Imu& m) {
  v.put("IMU.angular_rate_radps[2]", m.angular_rate_radps[2]);
  v.put("IMU.acceleration_mps2[0]", m.acceleration_mps2[0]);
  v.put("IMU.angular_rate_variance", m.angular_rate_variance);
  v.put("IMU.acceleration_variance", m.acceleration_variance);
  v.put("IMU.roll_rad", m.roll_rad);
  v.put("IMU.pitch_rad", m.pitch_rad);
  v.put("IMU.yaw_rad", m.yaw_rad);
  v.put("IMU.orientation_variance", m.orientation_variance);
  v.put("IMU.has_orientation", m.has_orientation);
}

void put(Values& v, const pose::TrajectoryPage& m) {
  v.put("TRAJECTORY.revision", m.revision);
  v.put("TRAJECTORY.page", m.page);
  v.put("TRAJECTORY.num_pages", m.num_pages);
  v.put("TRAJECTORY.num_poses", m.poses.size());
  const pose::PoseEstimate& pose = m.poses.at(1);
  v.put("TRAJECTORY.pose.utime", pose.utime);
  v.put("TRAJECTORY.pose.x_m", pose.x_m);
  v.put("TRAJECTORY.pose.y_m", pose.y_m);
  v.put("TRAJECTORY.pose.yaw_rad", pose.yaw_rad);
  v.put("TRAJECTORY.pose.covariance[5]", pose.covariance[5]);
}

void put_status(Values& v, const Status& m) {
  v.put("STATUS.level", static_cast<int>(m.level));
  v.put("STATUS.num_good", m.num_good);
  v.put("STATUS.num_bad", m.num_bad);
  v.put("STATUS.num_lost", m.num_lost);
  v.put("STATUS.num_late", m.num_late);
  v.put("STATUS.num_duplicate", m.num_duplicate);
  v.put("STATUS.num_published", m.num_published);
  v.put("STATUS.input_period_s", m.input_period_s);
  v.put("STATUS.latency_mean_s", m.latency_mean_s);
  v.put("STATUS.latency_max_s", m.latency_max_s);
  v.put("STATUS.name", m.name);
  v.put("STATUS.host", m.host);
  v.put("STATUS.text", m.text);
}

void put_config(Values& v, const ConfigNotice& m) {
  v.put("CONFIG.hash", m.hash);
  v.put("CONFIG.name", m.name);
  v.put("CONFIG.version", m.version);
  EXPECT_EQ(m.text, "pose:\n  mode: fixes\n");
}

void put_ack(Values& v, const Ack& m) {
  v.put("ACK.node", m.node);
  v.put("ACK.channel", static_cast<int>(m.channel));
  v.put("ACK.num_outputs", m.outputs.size());
  v.put("ACK.output_channels[1]", static_cast<int>(m.outputs.at(1).channel));
  v.put("ACK.output_seqs[1]", m.outputs.at(1).seq);
}

template <class Service>
const Service* decoded(const std::variant<Service, Rejection>& result) {
  const auto* rejection = std::get_if<Rejection>(&result);
  if (rejection != nullptr) ADD_FAILURE() << to_string(rejection->reason) << rejection->detail;
  return std::get_if<Service>(&result);
}

template <class Service>
void put_head(Values& v, const std::string& channel, const Service& m) {
  v.put(channel + ".utime", m.utime);
  v.put(channel + ".seq", m.seq);
}

void put_event(Values& v, Channel channel, const std::vector<std::uint8_t>& data) {
  const std::string name(info(channel).name);
  const auto service = [&](const auto& result, auto put_fields) {
    if (const auto* m = decoded(result)) {
      put_head(v, name, *m);
      put_fields(v, *m);
    }
  };
  switch (channel) {
    case Channel::kStatus:
      return service(decode_status(data.data(), data.size()), put_status);
    case Channel::kConfig:
      return service(decode_config(data.data(), data.size()), put_config);
    case Channel::kAck:
      return service(decode_ack(data.data(), data.size()), put_ack);
    case Channel::kReplay:
      return service(decode_replay(data.data(), data.size()),
                     [](Values& values, const ReplayMark& m) { values.put("REPLAY.end", m.end); });
    default:
      break;
  }
  const auto result = decode(channel, data.data(), data.size());
  if (const Message* message = decoded(result)) {
    v.put(name + ".utime", utime_of(*message));
    v.put(name + ".seq", seq_of(*message));
    std::visit([&v](const auto& m) { put(v, m); }, *message);
  }
}

std::map<std::string, std::string> read_truth(const std::string& path) {
  std::map<std::string, std::string> truth;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    const std::size_t blank = line.find(' ');
    if (line.empty() || line[0] == '#') continue;
    truth[line.substr(0, blank)] = line.substr(blank + 1);
  }
  return truth;
}

/// Decodes every message of a golden log and compares it with what the text beside it states.
void expect_stays_readable(const std::string& name, std::size_t num_channels) {
  const std::string folder = ORCHARD_SOURCE_DIR "/tests/data/";
  Values values;
  io::LogReader reader(folder + name + ".lcm");
  while (const auto event = reader.next()) {
    const auto channel = find_channel(event->channel);
    ASSERT_TRUE(channel.has_value()) << event->channel;
    values.count(event->channel);
    put_event(values, *channel, event->data);
    EXPECT_EQ(event->timestamp_us, std::stoll(values.texts().at(event->channel + ".utime")));
  }
  EXPECT_TRUE(reader.gaps().empty());
  EXPECT_LT(reader.file_size(), 60000u);
  const auto truth = read_truth(folder + name + ".txt");
  std::size_t num_counts = 0;
  for (const auto& [key, text] : truth) {
    num_counts += key.find(".count") != std::string::npos;
    const auto found = values.texts().find(key);
    ASSERT_NE(found, values.texts().end()) << key << " was not decoded";
    EXPECT_EQ(found->second, text) << key;
  }
  EXPECT_EQ(num_counts, num_channels);
  EXPECT_GT(truth.size(), 15 * num_counts / 2);
}

TEST(GoldenLog, LogsOfTheFirstReleaseStayReadable) {
  expect_stays_readable("golden", kNumFirstChannels);
}

TEST(GoldenLog, LogsOfLaterTypesStayReadable) {
  expect_stays_readable("golden_2", 2);
  expect_stays_readable("golden_3", 2);
}

TEST(GoldenLog, OlderFormsAreGuardedAsTheNewOnesAre) {
  io::LogReader reader(ORCHARD_SOURCE_DIR "/tests/data/golden.lcm");
  std::vector<std::uint8_t> bytes;
  while (const auto event = reader.next()) {
    if (event->channel == info(Channel::kDetections).name) bytes = event->data;
  }
  ASSERT_FALSE(bytes.empty());
  const auto reason_of = [](const std::vector<std::uint8_t>& data) {
    return std::get<Rejection>(decode(Channel::kDetections, data.data(), data.size())).reason;
  };
  std::vector<std::uint8_t> many = bytes;
  many[20] = 0x7f;  // the highest byte of num_trunks
  EXPECT_EQ(reason_of(many), Reason::kBadCount);
  many[20] = 0xff;
  EXPECT_EQ(reason_of(many), Reason::kBadCount);
  EXPECT_EQ(reason_of({bytes.begin(), bytes.end() - 1}), Reason::kBadCount);
  EXPECT_EQ(reason_of({bytes.begin(), bytes.begin() + 31}), Reason::kTooShort);
  // On another channel they are of a wrong type.
  EXPECT_EQ(std::get<Rejection>(decode(Channel::kPose, bytes.data(), bytes.size())).reason,
            Reason::kWrongType);
}

}  // namespace
}  // namespace orchard::bus
