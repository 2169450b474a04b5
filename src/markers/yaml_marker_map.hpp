// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "sextant/markers/marker_map.hpp"

namespace sextant {

/// Parses the YAML format of doc/reference/marker_map.md. @throws std::runtime_error "path:line: reason"
MarkerMap parseYamlMap(const std::string& text, const std::string& path);
/// Formats a map as YAML.
std::string formatYamlMap(const MarkerMap& map);

}  // namespace sextant
