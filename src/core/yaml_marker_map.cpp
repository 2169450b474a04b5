// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "yaml_marker_map.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "atomic_file.hpp"

namespace sextant {
namespace {

// A mistake at a place in the file.
struct Mistake : std::runtime_error {
  Mistake(const YAML::Mark& mark, const std::string& what)
      : std::runtime_error(what), line(std::max(1, mark.line + 1)) {}
  int line;
};

void requireKeys(const YAML::Node& node, const std::string& what, const std::set<std::string>& needed,
                 const std::set<std::string>& optional) {
  if (!node.IsMap()) throw Mistake(node.Mark(), what + " must be a table of names and values");
  std::set<std::string> found;
  for (const auto& item : node) {
    const std::string key = item.first.Scalar();
    if (needed.count(key) + optional.count(key) == 0)
      throw Mistake(item.first.Mark(), "unknown name '" + key + "' in " + what);
    if (!found.insert(key).second) throw Mistake(item.first.Mark(), "'" + key + "' is there twice");
  }
  for (const std::string& key : needed)
    if (found.count(key) == 0) throw Mistake(node.Mark(), what + " lacks '" + key + "'");
}

double number(const YAML::Node& node) {
  double value = NAN;
  if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !std::isfinite(value))
    throw Mistake(node.Mark(),
                  "needs a finite number" + (node.IsScalar() ? ", not '" + node.Scalar() + "'" : ""));
  return value;
}

std::string word(const YAML::Node& node) {
  if (!node.IsScalar() || node.Scalar().empty()) throw Mistake(node.Mark(), "needs a name");
  return node.Scalar();
}

Eigen::VectorXd numbers(const YAML::Node& node, size_t count) {
  if (!node.IsSequence() || node.size() != count)
    throw Mistake(node.Mark(), "needs a list of " + std::to_string(count) + " numbers");
  Eigen::VectorXd values(count);
  for (size_t i = 0; i < count; ++i) values[i] = number(node[i]);
  return values;
}

// A deviation for all three axes, or one for each.
Eigen::Vector3d deviations(const YAML::Node& node) {
  Eigen::Vector3d sigma;
  if (node.IsScalar())
    sigma.setConstant(number(node));
  else
    sigma = numbers(node, 3);
  if ((sigma.array() < 0).any()) throw Mistake(node.Mark(), "a standard deviation cannot be negative");
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
      throw Mistake(full.Mark(), "give either covariance or sigma_position and sigma_rotation");
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
  int id = 0;
  if (!node["id"].IsScalar() || !YAML::convert<int>::decode(node["id"], id))
    throw Mistake(node["id"].Mark(), "needs a whole number");
  return {{word(node["family"]), id},
          number(node["size"]),
          node["name"] ? word(node["name"]) : "",
          pose(node),
          covariance(node)};
}

MappedFrame frame(const YAML::Node& node) {
  requireKeys(node, "a frame", {"name", "parent", "position", "rpy"}, {});
  return {word(node["name"]), word(node["parent"]), pose(node)};
}

// Calls add for every item of the list, so that what it refuses is told with the item's line.
template <typename Add>
void forEach(const YAML::Node& list, const std::string& name, Add add) {
  if (!list) return;
  if (!list.IsSequence()) throw Mistake(list.Mark(), "'" + name + "' must be a list");
  for (const YAML::Node& item : list) {
    try {
      add(item);
    } catch (const std::invalid_argument& error) {
      throw Mistake(item.Mark(), error.what());
    }
  }
}

MarkerMap parse(const YAML::Node& root) {
  requireKeys(root, "a marker map", {"frame", "markers"}, {"frames"});
  MarkerMap map(word(root["frame"]));
  forEach(root["markers"], "markers", [&](const YAML::Node& node) { map.add(marker(node)); });
  forEach(root["frames"], "frames", [&](const YAML::Node& node) { map.addFrame(frame(node)); });
  return map;
}

std::string list(const double* values, int count) {
  std::string text = "[";
  for (int i = 0; i < count; ++i) text += (i ? ", " : "") + shortestDecimal(values[i]);
  return text + "]";
}

std::string quoted(const std::string& text) {
  YAML::Emitter out;
  out << YAML::DoubleQuoted << text;
  return out.c_str();
}

std::string formatPose(const Pose& pose) {
  const Eigen::Vector3d rpy = rpyFromRotation(pose.linear());
  return "position: " + list(pose.translation().data(), 3) + ", rpy: " + list(rpy.data(), 3);
}

std::string formatMarker(const MappedMarker& marker) {
  std::string text = "  - {family: " + marker.key.family + ", id: " + std::to_string(marker.key.id) +
                     ", size: " + shortestDecimal(marker.size) + ", name: " + quoted(marker.name) +
                     ",\n     " + formatPose(marker.T_map_marker);
  const Matrix6d& covariance = marker.covariance;
  if (!covariance.isZero(0.0)) text += ",\n     covariance: " + list(covariance.data(), 36);
  return text + "}\n";
}

}  // namespace

MarkerMap parseYamlMap(const std::string& text, const std::string& path) {
  try {
    return parse(YAML::Load(text));
  } catch (const Mistake& mistake) {
    throw std::runtime_error(path + ":" + std::to_string(mistake.line) + ": " + mistake.what());
  } catch (const YAML::Exception& error) {
    throw std::runtime_error(path + ":" + std::to_string(error.mark.line + 1) + ": " + error.msg);
  }
}

std::string formatYamlMap(const MarkerMap& map) {
  std::string text =
      "# Poses take the marker's frame to the map's: metres; roll, pitch, yaw in radians.\nframe: " +
      quoted(map.frame()) + "\nmarkers:" + (map.markers().empty() ? " []\n" : "\n");
  for (const auto& entry : map.markers()) text += formatMarker(entry.second);
  if (!map.frames().empty()) text += "frames:\n";
  for (const MappedFrame& frame : map.frames())
    text += "  - {name: " + quoted(frame.name) + ", parent: " + quoted(frame.parent) + ",\n     " +
            formatPose(frame.T_parent_frame) + "}\n";
  return text;
}

}  // namespace sextant
