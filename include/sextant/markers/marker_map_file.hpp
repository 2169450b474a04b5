// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

#include "sextant/base/params.hpp"
#include "sextant/markers/marker_map.hpp"

namespace sextant {

/// What the plain text format does not say of its markers.
struct TextMapParams {
  std::string frame = "map";
  std::string family = "tag36h11";
  double size = 0.2;
  std::map<int, double> sizes;
  std::map<std::string, std::string> parents;

  ParamList fields();
};

/// Reads a marker map: ".yaml" and ".yml" as YAML (doc/marker_map.md), anything else as the plain text
/// format, a line a frame: "name Tx Ty Tz Rx Ry Rz" (metres, radians). A name that ends in a number is that
/// marker; "#" starts a comment. Nothing is taken from a file with a mistake in it.
/// @throws std::runtime_error "file:line: reason" for anything unreadable, unknown, out of range or given
/// twice.
MarkerMap readMarkerMap(const std::string& path, const TextMapParams& text = {});

/// Writes YAML, or the plain text format for any other ending, atomically (temporary file, fsync, rename).
/// @throws std::runtime_error when the file cannot be written, or when the text format cannot hold the map.
/// @param text what a plain text file will be read with
void writeMarkerMap(const MarkerMap& map, const std::string& path, const TextMapParams& text = {});

}  // namespace sextant
