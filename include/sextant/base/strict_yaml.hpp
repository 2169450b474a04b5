// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <algorithm>
#include <set>
#include <stdexcept>
#include <string>

namespace sextant {

/// A mistake at a place in a file.
struct YamlMistake : std::runtime_error {
  YamlMistake(const YAML::Mark& mark, const std::string& what)
      : std::runtime_error(what), line(std::max(1, mark.line + 1)) {}
  int line;
};

/// Each reads a node or throws YamlMistake with what is wrong.
/// @{
void requireKeys(const YAML::Node& node, const std::string& what, const std::set<std::string>& needed,
                 const std::set<std::string>& optional);
double number(const YAML::Node& node);
int wholeNumber(const YAML::Node& node);
bool truth(const YAML::Node& node);
std::string word(const YAML::Node& node);
Eigen::VectorXd numbers(const YAML::Node& node, size_t count);
/// @}

/// As text that those read.
/// @{
std::string listText(const double* values, size_t count);
std::string quotedText(const std::string& text);
/// @}

/// Calls add for every item of the list, so that what it refuses is told with the item's line.
template <typename Add>
void forEach(const YAML::Node& list, const std::string& name, Add add) {
  if (!list) return;
  if (!list.IsSequence()) throw YamlMistake(list.Mark(), "'" + name + "' must be a list");
  for (const YAML::Node& item : list) {
    try {
      add(item);
    } catch (const std::invalid_argument& error) {
      throw YamlMistake(item.Mark(), error.what());
    }
  }
}

/// @throws std::runtime_error "path:line: reason"
template <typename Parse>
auto parseYaml(const std::string& text, const std::string& path, Parse parse) {
  try {
    return parse(YAML::Load(text));
  } catch (const YamlMistake& mistake) {
    throw std::runtime_error(path + ":" + std::to_string(mistake.line) + ": " + mistake.what());
  } catch (const YAML::Exception& error) {
    throw std::runtime_error(path + ":" + std::to_string(error.mark.line + 1) + ": " + error.msg);
  }
}

}  // namespace sextant
