// SPDX-License-Identifier: BSD-3-Clause
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "io/bag/foxglove_json.hpp"

namespace orchard::io {
namespace {

using Json = nlohmann::json;
using Fields = std::vector<std::pair<const char*, Json>>;

Json object(const Fields& fields) {
  Json properties = Json::object();
  for (const auto& [name, schema] : fields) properties[name] = schema;
  return {{"type", "object"}, {"properties", properties}};
}
Json array(const Json& items) { return {{"type", "array"}, {"items", items}}; }
Json text() { return {{"type", "string"}}; }
Json bytes() { return {{"type", "string"}, {"contentEncoding", "base64"}}; }
Json real() { return {{"type", "number"}}; }
Json whole() { return {{"type", "integer"}}; }
Json yes_or_no() { return {{"type", "boolean"}}; }
Json moment(const char* title) {
  Json schema = object({{"sec", whole()}, {"nsec", whole()}});
  schema["title"] = title;  // viewers identify a time by it
  return schema;
}
Json time() { return moment("time"); }
Json vector() { return object({{"x", real()}, {"y", real()}, {"z", real()}}); }
Json quaternion() { return object({{"x", real()}, {"y", real()}, {"z", real()}, {"w", real()}}); }
Json pose() { return object({{"position", vector()}, {"orientation", quaternion()}}); }
Json colour() { return object({{"r", real()}, {"g", real()}, {"b", real()}, {"a", real()}}); }
Json timed(Fields fields) {
  fields.insert(fields.begin(), {"timestamp", time()});
  return object(fields);
}
Json transforms() {
  return object({{"transforms", array(timed({{"parent_frame_id", text()},
                                             {"child_frame_id", text()},
                                             {"translation", vector()},
                                             {"rotation", quaternion()}}))}});
}
Json scene() {
  const Json cylinder = object({{"pose", pose()},
                                {"size", vector()},
                                {"bottom_scale", real()},
                                {"top_scale", real()},
                                {"color", colour()}});
  const Json line = object({{"type", whole()},
                            {"pose", pose()},
                            {"thickness", real()},
                            {"scale_invariant", yes_or_no()},
                            {"points", array(vector())},
                            {"color", colour()},
                            {"colors", array(colour())},
                            {"indices", array(whole())}});
  const Json words = object({{"pose", pose()},
                             {"billboard", yes_or_no()},
                             {"font_size", real()},
                             {"scale_invariant", yes_or_no()},
                             {"color", colour()},
                             {"text", text()}});
  const Json unused = object({{"pose", pose()}});
  const Json entity = timed({{"frame_id", text()},
                             {"id", text()},
                             {"lifetime", moment("duration")},
                             {"frame_locked", yes_or_no()},
                             {"metadata", array(object({{"key", text()}, {"value", text()}}))},
                             {"arrows", array(unused)},
                             {"cubes", array(unused)},
                             {"spheres", array(unused)},
                             {"cylinders", array(cylinder)},
                             {"lines", array(line)},
                             {"triangles", array(unused)},
                             {"texts", array(words)},
                             {"models", array(unused)}});
  return object({{"deletions", array(timed({{"type", whole()}, {"id", text()}}))},
                 {"entities", array(entity)}});
}

Json schema_of(const std::string& name) {
  static const std::map<std::string, Json> kSchemas{
      {"foxglove.LaserScan", timed({{"frame_id", text()},
                                    {"pose", pose()},
                                    {"start_angle", real()},
                                    {"end_angle", real()},
                                    {"ranges", array(real())},
                                    {"intensities", array(real())}})},
      {"foxglove.CompressedImage",
       timed({{"frame_id", text()}, {"data", bytes()}, {"format", text()}})},
      {"foxglove.RawImage", timed({{"frame_id", text()},
                                   {"width", whole()},
                                   {"height", whole()},
                                   {"encoding", text()},
                                   {"step", whole()},
                                   {"data", bytes()}})},
      {"foxglove.LocationFix", timed({{"frame_id", text()},
                                      {"latitude", real()},
                                      {"longitude", real()},
                                      {"altitude", real()},
                                      {"position_covariance", array(real())},
                                      {"position_covariance_type", whole()}})},
      {"foxglove.PoseInFrame", timed({{"frame_id", text()}, {"pose", pose()}})},
      {"foxglove.FrameTransforms", transforms()},
      {"foxglove.CameraCalibration", timed({{"frame_id", text()},
                                            {"width", whole()},
                                            {"height", whole()},
                                            {"distortion_model", text()},
                                            {"D", array(real())},
                                            {"K", array(real())},
                                            {"R", array(real())},
                                            {"P", array(real())}})},
      {"foxglove.SceneUpdate", scene()},
      {"orchard.Odometry", timed({{"speed_mps", real()}, {"yaw_rate_radps", real()}})},
      {"orchard.Imu", timed({{"angular_rate_radps", vector()}, {"acceleration_mps2", vector()}})}};
  return kSchemas.at(name);
}

}  // namespace

FoxgloveSchema foxglove_schema(const char* name) { return {name, schema_of(name).dump()}; }

}  // namespace orchard::io
