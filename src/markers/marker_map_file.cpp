// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/marker_map_file.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "sextant/base/atomic_file.hpp"
#include "text_marker_map.hpp"
#include "yaml_marker_map.hpp"

namespace sextant {
namespace {

bool isYaml(const std::string& path) {
  const auto has = [&](const std::string& extension) {
    return path.size() >= extension.size() &&
           path.compare(path.size() - extension.size(), extension.size(), extension) == 0;
  };
  return has(".yaml") || has(".yml");
}

}  // namespace

MarkerMap readMarkerMap(const std::string& path, const TextMapParams& text) {
  std::ifstream file(path);
  std::string content;
  if (file) content.assign(std::istreambuf_iterator<char>(file), {});
  if (!file.is_open() || file.bad())
    throw std::runtime_error(path + ": cannot be read: " + std::strerror(errno));
  return parseMarkerMap(content, path, text);
}

MarkerMap parseMarkerMap(const std::string& content, const std::string& path, const TextMapParams& text) {
  if (isYaml(path)) return parseYamlMap(content, path);
  std::istringstream lines(content);
  return parseTextMap(lines, path, text);
}

void writeMarkerMap(const MarkerMap& map, const std::string& path, const TextMapParams& text) {
  writeFileAtomically(path, isYaml(path) ? formatYamlMap(map) : formatTextMap(map, text));
}

}  // namespace sextant
