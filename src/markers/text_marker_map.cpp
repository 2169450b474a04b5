// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "text_marker_map.hpp"

#include <cctype>
#include <cmath>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "sextant/base/decimal_text.hpp"
#include "sextant/markers/marker_family.hpp"

namespace sextant {
namespace {

constexpr size_t kFields = 7;  // in a line: name, Tx Ty Tz, Rx Ry Rz

// Returns the number at the end of a name: "7", "Id7" and "door_7" are marker 7.
std::optional<int> trailingId(const std::string& name) {
  size_t begin = name.size();
  while (begin > 0 && std::isdigit(static_cast<unsigned char>(name[begin - 1]))) --begin;
  if (begin == name.size()) return std::nullopt;
  if (name.size() - begin > 9)
    throw std::invalid_argument("'" + name + "': the number is too large for a marker id");
  return std::stoi(name.substr(begin));
}

double parsedNumber(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (end == text.c_str() || *end != 0) throw std::invalid_argument("'" + text + "' is not a number");
  if (!std::isfinite(value)) throw std::invalid_argument("'" + text + "' is not finite");
  return value;
}

std::vector<std::string> fields(const std::string& line) {
  std::istringstream in(line.substr(0, line.find('#')));
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

double sizeOf(int id, const TextMapParams& params) {
  const auto size = params.sizes.find(id);
  return size == params.sizes.end() ? params.size : size->second;
}

std::string parentOf(const std::string& name, const TextMapParams& params) {
  const auto parent = params.parents.find(name);
  return parent == params.parents.end() ? params.frame : parent->second;
}

void addLine(const std::vector<std::string>& words, const TextMapParams& params, MarkerMap& map) {
  if (words.size() != kFields)
    throw std::invalid_argument("has " + std::to_string(words.size()) +
                                " fields, needs 'name Tx Ty Tz Rx Ry Rz'");
  double v[6];
  for (int i = 0; i < 6; ++i) v[i] = parsedNumber(words[i + 1]);
  const Pose pose = poseFromXyzRpy({v[0], v[1], v[2]}, {v[3], v[4], v[5]});
  const std::string& name = words[0];
  if (const auto id = trailingId(name)) {
    map.add({{params.family, *id}, sizeOf(*id, params), name, pose, Matrix6d::Zero()});
    return;
  }
  map.addFrame({name, parentOf(name, params), pose});
}

std::string formatLine(const std::string& name, const Pose& pose) {
  std::string line = name;
  const Eigen::Vector3d rpy = rpyFromRotation(pose.linear());
  for (int i = 0; i < 3; ++i) line += " " + shortestDecimal(pose.translation()[i]);
  for (int i = 0; i < 3; ++i) line += " " + shortestDecimal(rpy[i]);
  return line + "\n";
}

[[noreturn]] void refuse(const std::string& what, const std::string& why) {
  throw std::runtime_error("the plain text format cannot represent " + what + ": " + why +
                           "; write a .yaml file");
}

void requireTextual(const MappedMarker& marker, const TextMapParams& params) {
  const std::string what = "marker '" + marker.name + "'";
  if (trailingId(marker.name) != marker.key.id) refuse(what, "its name does not end with its id");
  if (marker.key.family != canonicalFamily(params.family))
    refuse(what, "it is of family " + marker.key.family);
  if (marker.size != sizeOf(marker.key.id, params))
    refuse(what, "its size is " + shortestDecimal(marker.size) + " m");
  if (!marker.covariance.isZero(0.0)) refuse(what, "it has a covariance");
}

}  // namespace

ParamList TextMapParams::fields() {
  return {
      {"frame", &frame, notEmpty(), "", "plain text map: frame of the map"},
      {"family", &family, Allowed("[families](#marker-families)", nullptr), "",
       "plain text map: family of all markers"},
      {"size", &size, Range::openLow(0, 100), "m", "plain text map: edge length of the markers"},
      {"sizes", &sizes, Range::openLow(0, 100), "m",
       "plain text map: edge lengths of individual markers, by `\"ID\"`, e.g. `{\"7\": 0.1}`"},
      {"parents", &parents, Allowed(), "",
       "plain text map: parents of frames that are not markers, by name, e.g. `{camera: base_link}`; "
       "default: the frame of the map"},
  };
}

MarkerMap parseTextMap(std::istream& in, const std::string& path, const TextMapParams& params) {
  validate(params);
  MarkerMap map(params.frame);
  std::string line;
  for (int n = 1; std::getline(in, line); ++n) {
    const auto words = fields(line);
    if (words.empty()) continue;
    try {
      addLine(words, params, map);
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error(path + ":" + std::to_string(n) + ": " + error.what());
    }
  }
  if (in.bad()) throw std::runtime_error(path + ": could not be read to its end");
  return map;
}

std::string formatTextMap(const MarkerMap& map, const TextMapParams& params) {
  if (map.frame() != params.frame) refuse("the frame of the map", "it is '" + map.frame() + "'");
  std::string text =
      "# name Tx Ty Tz Rx Ry Rz: metres; roll, pitch, yaw in radians; parent " + map.frame() + "\n";
  for (const auto& entry : map.markers()) {
    requireTextual(entry.second, params);
    text += formatLine(entry.second.name, entry.second.T_map_marker);
  }
  for (const MappedFrame& frame : map.frames()) {
    if (frame.parent != parentOf(frame.name, params))
      refuse("frame '" + frame.name + "'", "its parent is '" + frame.parent + "'");
    text += formatLine(frame.name, frame.T_parent_frame);
  }
  return text;
}

}  // namespace sextant
