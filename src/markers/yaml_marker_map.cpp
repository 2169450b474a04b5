// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "yaml_marker_map.hpp"

#include "sextant/base/decimal_text.hpp"
#include "sextant/base/strict_yaml.hpp"

namespace sextant {
namespace {

// Reads one standard deviation for all three axes, or one for each axis.
Eigen::Vector3d deviations(const YAML::Node& node) {
  Eigen::Vector3d sigma;
  if (node.IsScalar())
    sigma.setConstant(number(node));
  else
    sigma = numbers(node, 3);
  if ((sigma.array() < 0).any()) throw YamlError(node.Mark(), "a standard deviation cannot be negative");
  return sigma;
}

Pose pose(const YAML::Node& node) {
  return poseFromXyzRpy(numbers(node["position"], 3), numbers(node["rpy"], 3));
}

Matrix6d covariance(const YAML::Node& node) {
  Matrix6d matrix = Matrix6d::Zero();
  const YAML::Node full = node["covariance"];
  if (full) {
    if (node["sigma_position"] || node["sigma_rotation"])
      throw YamlError(full.Mark(), "covariance cannot be combined with sigma_position or sigma_rotation");
    return Eigen::Map<const Matrix6d>(numbers(full, 36).data());
  }
  if (const YAML::Node sigma = node["sigma_position"])
    matrix.topLeftCorner<3, 3>() = deviations(sigma).array().square().matrix().asDiagonal();
  if (const YAML::Node sigma = node["sigma_rotation"])
    matrix.bottomRightCorner<3, 3>() = deviations(sigma).array().square().matrix().asDiagonal();
  return matrix;
}

MappedMarker marker(const YAML::Node& node) {
  requireKeys(node, "a marker", {"family", "id", "size", "position", "rpy"},
              {"name", "sigma_position", "sigma_rotation", "covariance"});
  return {{nonEmptyText(node["family"]), wholeNumber(node["id"])},
          number(node["size"]),
          node["name"] ? nonEmptyText(node["name"]) : "",
          pose(node),
          covariance(node)};
}

MappedFrame frame(const YAML::Node& node) {
  requireKeys(node, "a frame", {"name", "parent", "position", "rpy"}, {});
  return {nonEmptyText(node["name"]), nonEmptyText(node["parent"]), pose(node)};
}

MarkerMap parse(const YAML::Node& root) {
  requireKeys(root, "a marker map", {"frame", "markers"}, {"frames"});
  MarkerMap map(nonEmptyText(root["frame"]));
  forEach(root["markers"], "markers", [&](const YAML::Node& node) { map.add(marker(node)); });
  forEach(root["frames"], "frames", [&](const YAML::Node& node) { map.addFrame(frame(node)); });
  return map;
}

std::string formatPose(const Pose& pose) {
  const Eigen::Vector3d rpy = rpyFromRotation(pose.linear());
  return "position: " + listText(pose.translation().data(), 3) + ", rpy: " + listText(rpy.data(), 3);
}

std::string formatMarker(const MappedMarker& marker) {
  std::string text = "  - {family: " + marker.key.family + ", id: " + std::to_string(marker.key.id) +
                     ", size: " + shortestDecimal(marker.size) + ", name: " + quotedText(marker.name) +
                     ",\n     " + formatPose(marker.T_map_marker);
  const Matrix6d& covariance = marker.covariance;
  if (!covariance.isZero(0.0)) text += ",\n     covariance: " + listText(covariance.data(), 36);
  return text + "}\n";
}

}  // namespace

MarkerMap parseYamlMap(const std::string& text, const std::string& path) {
  return parseYaml(text, path, parse);
}

std::string formatYamlMap(const MarkerMap& map) {
  std::string text =
      "# position in metres; rpy: roll, pitch, yaw in radians. Markers: in the map. Frames: in their "
      "parent.\n"
      "frame: " +
      quotedText(map.frame()) + "\nmarkers:" + (map.markers().empty() ? " []\n" : "\n");
  for (const auto& entry : map.markers()) text += formatMarker(entry.second);
  if (!map.frames().empty()) text += "frames:\n";
  for (const MappedFrame& frame : map.frames())
    text += "  - {name: " + quotedText(frame.name) + ", parent: " + quotedText(frame.parent) + ",\n     " +
            formatPose(frame.T_parent_frame) + "}\n";
  return text;
}

}  // namespace sextant
