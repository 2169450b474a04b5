// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <istream>
#include <string>

#include "sextant/markers/marker_map_file.hpp"

namespace sextant {

/// Parses the plain text format. @throws std::runtime_error "path:line: reason"
MarkerMap parseTextMap(std::istream& in, const std::string& path, const TextMapParams& params);
/// Formats a map as plain text.
/// @throws std::runtime_error for a map that would change when it is read with these parameters
std::string formatTextMap(const MarkerMap& map, const TextMapParams& params);

}  // namespace sextant
