// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "sextant/markers/marker_map.hpp"

namespace sextant {

/// The YAML format of doc/marker_map.md. @throws std::runtime_error "path:line: reason"
MarkerMap parseYamlMap(const std::string& text, const std::string& path);
std::string formatYamlMap(const MarkerMap& map);

}  // namespace sextant
