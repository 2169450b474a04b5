// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_map_file.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

#include "sextant/base/atomic_file.hpp"
#include "sextant/base/decimal_text.hpp"
#include "sextant/base/strict_yaml.hpp"

namespace sextant {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Largest tolerated negative eigenvalue of the covariance, relative to its largest element.
constexpr double kNegativeEigenvalue = 1e-9;

Index dimensionOf(const std::vector<Landmark2D>& landmarks) {
  Index dimension = 3;
  for (const Landmark2D& landmark : landmarks) dimension += landmark.dimension();
  return dimension;
}

bool isFinite(const LandmarkMap& map) {
  return map.T_map_base.position.allFinite() && std::isfinite(map.T_map_base.heading) &&
         std::all_of(map.landmarks.begin(), map.landmarks.end(), [](const Landmark2D& each) {
           return each.position.allFinite() && std::isfinite(each.heading.value_or(0));
         });
}

void addLandmark(const YAML::Node& node, LandmarkMap& map) {
  requireKeys(node, "a landmark", {"class", "position"}, {"id", "heading"});
  Landmark2D landmark{numbers(node["position"], 2), {}};
  LandmarkLabel label{nonEmptyText(node["class"]), {}};
  if (node["heading"]) landmark.heading = number(node["heading"]);
  if (node["id"]) label.id = wholeNumber(node["id"]);
  if (label.id && std::find(map.labels.begin(), map.labels.end(), label) != map.labels.end())
    throw YamlError(node.Mark(), "this id occurs twice in this class");
  map.landmarks.push_back(landmark);
  map.labels.push_back(label);
}

/// Reads the rows of the lower triangle.
MatrixXd lowerRows(const YAML::Node& node, Index size) {
  if (!node.IsSequence() || static_cast<Index>(node.size()) != size)
    throw YamlError(node.Mark(), "needs " + std::to_string(size) +
                                     " rows: 3 for the robot, 2 for each landmark, 3 "
                                     "for one with a heading");
  MatrixXd lower = MatrixXd::Zero(size, size);
  Index row = 0;
  for (const YAML::Node& values : node) {
    lower.row(row).head(row + 1) = numbers(values, row + 1).transpose();
    ++row;
  }
  return lower.selfadjointView<Eigen::Lower>();
}

LandmarkMap parse(const YAML::Node& root) {
  requireKeys(root, "a landmark map", {"frame", "robot", "landmarks", "covariance"}, {"lost"});
  LandmarkMap map;
  map.frame = nonEmptyText(root["frame"]);
  const Eigen::VectorXd robot = numbers(root["robot"], 3);
  map.T_map_base = {robot.head<2>(), robot(2)};
  if (root["lost"]) map.is_lost = boolean(root["lost"]);
  forEach(root["landmarks"], "landmarks", [&](const YAML::Node& node) { addLandmark(node, map); });
  map.covariance = lowerRows(root["covariance"], dimensionOf(map.landmarks));
  try {
    map.validate();
  } catch (const std::invalid_argument& error) {
    throw YamlError(root["covariance"].Mark(), error.what());
  }
  return map;
}

void requireLabels(const LandmarkMap& map) {
  const auto& labels = map.labels;
  if (labels.size() != map.landmarks.size()) throw std::invalid_argument("every landmark needs a label");
  const auto has_no_class = [](const LandmarkLabel& label) { return label.class_name.empty(); };
  if (map.frame.empty() || std::any_of(labels.begin(), labels.end(), has_no_class))
    throw std::invalid_argument("the frame and every class need a name");
  for (size_t i = 0; i < labels.size(); ++i)
    if (labels[i].id && std::count(labels.begin(), labels.end(), labels[i]) > 1)
      throw std::invalid_argument("id " + std::to_string(*labels[i].id) + " of class " +
                                  labels[i].class_name + " occurs twice");
}

std::string landmarkText(const Landmark2D& landmark, const LandmarkLabel& label) {
  std::string text = "  - {class: " + quotedText(label.class_name);
  if (label.id) text += ", id: " + std::to_string(*label.id);
  text += ", position: " + listText(landmark.position.data(), 2);
  if (landmark.heading) text += ", heading: " + shortestDecimal(*landmark.heading);
  return text + "}\n";
}

}  // namespace

void LandmarkMap::validate() const {
  requireLabels(*this);
  if (covariance.rows() != dimensionOf(landmarks) || covariance.cols() != covariance.rows())
    throw std::invalid_argument("the covariance needs " + std::to_string(dimensionOf(landmarks)) +
                                " rows and columns");
  if (!covariance.allFinite())
    throw std::invalid_argument("the covariance has an element that is not finite");
  if (!isFinite(*this)) throw std::invalid_argument("a position or a heading is not finite");
  const double tolerance = kNegativeEigenvalue * covariance.cwiseAbs().maxCoeff();
  const MatrixXd shifted = covariance + tolerance * MatrixXd::Identity(covariance.rows(), covariance.cols());
  if (tolerance > 0 && shifted.llt().info() != Eigen::Success)
    throw std::invalid_argument("the covariance has a negative eigenvalue");
}

LandmarkMap readLandmarkMap(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  file.peek();  // fails if the path is a folder
  if (!file.is_open() || file.bad())
    throw std::runtime_error(path + ": cannot be read: " + std::strerror(errno));
  text << file.rdbuf();
  return parseYaml(text.str(), path, parse);
}

void writeLandmarkMap(const LandmarkMap& map, const std::string& path) {
  map.validate();
  const double robot[] = {map.T_map_base.position.x(), map.T_map_base.position.y(), map.T_map_base.heading};
  std::string text =
      "# Metres and radians. The covariance's lower triangle, rows and columns: x, y, heading of the robot,\n"
      "# then x, y[, heading] of each landmark.\nframe: " +
      quotedText(map.frame) + "\nrobot: " + listText(robot, 3) + (map.is_lost ? "\nlost: true" : "") +
      "\nlandmarks:" + (map.landmarks.empty() ? " []\n" : "\n");
  for (size_t i = 0; i < map.landmarks.size(); ++i) text += landmarkText(map.landmarks[i], map.labels[i]);
  text += "covariance:\n";
  for (Index row = 0; row < map.covariance.rows(); ++row) {
    const Eigen::VectorXd values = map.covariance.row(row).head(row + 1);
    text += "  - " + listText(values.data(), values.size()) + "\n";
  }
  writeFileAtomically(path, text);
}

}  // namespace sextant
