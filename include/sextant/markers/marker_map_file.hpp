// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

#include "sextant/base/params.hpp"
#include "sextant/markers/marker_map.hpp"

namespace sextant {

/// Properties of the markers that the plain text format does not contain.
struct TextMapParams {
  std::string frame = "map";
  std::string family = "tag36h11";
  double size = 0.2;
  std::map<int, double> sizes;
  std::map<std::string, std::string> parents;

  ParamList fields();
};

/// Reads a marker map: ".yaml" and ".yml" as YAML (doc/reference/marker_map.md), any other file in the plain
/// text format with one frame per line: "name Tx Ty Tz Rx Ry Rz" (metres, radians). A name that ends in a
/// number is the marker with this id; "#" starts a comment.
/// @param text properties that the plain text format does not contain
/// @throws std::runtime_error "file:line: reason" for anything unreadable, unknown, out of range or given
/// twice
MarkerMap readMarkerMap(const std::string& path, const TextMapParams& text = {});

/// Parses the content of a marker map file.
/// @param path selects the format as in readMarkerMap(), and is named in errors
/// @throws std::runtime_error as readMarkerMap()
MarkerMap parseMarkerMap(const std::string& content, const std::string& path, const TextMapParams& text = {});

/// Writes a marker map atomically: ".yaml" and ".yml" as YAML, any other file in the plain text format.
/// @param text properties with which a plain text file will be read
/// @throws std::runtime_error if the file cannot be written or the plain text format cannot represent the map
void writeMarkerMap(const MarkerMap& map, const std::string& path, const TextMapParams& text = {});

}  // namespace sextant
