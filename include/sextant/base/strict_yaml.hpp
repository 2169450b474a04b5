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

/// An error at a line of a YAML file.
struct YamlError : std::runtime_error {
  /// Error at the line of a mark.
  YamlError(const YAML::Mark& mark, const std::string& what)
      : std::runtime_error(what), line(std::max(1, mark.line + 1)) {}
  int line;  ///< line number, from 1
};

/// Checks and readers of a node. Each throws YamlError if the node does not have the expected form.
/// @{
/// Checks that a node is a map that has all required keys, and no keys except required and optional ones.
/// @param what name of the node in the error message
void requireKeys(const YAML::Node& node, const std::string& what, const std::set<std::string>& required,
                 const std::set<std::string>& optional);
double number(const YAML::Node& node);  ///< finite
int wholeNumber(const YAML::Node& node);
bool boolean(const YAML::Node& node);
std::string nonEmptyText(const YAML::Node& node);
Eigen::VectorXd numbers(const YAML::Node& node, size_t count);  ///< a list of count finite numbers
/// @}

/// Formats values as YAML text that the readers above read back.
/// @{
std::string listText(const double* values, size_t count);
std::string quotedText(const std::string& text);
/// @}

/// Calls add for every item of a list; a missing key counts as an empty list. A std::invalid_argument from
/// add becomes a YamlError at the item's line.
template <typename Add>
void forEach(const YAML::Node& list, const std::string& name, Add add) {
  if (!list) return;
  if (!list.IsSequence()) throw YamlError(list.Mark(), "'" + name + "' must be a list");
  for (const YAML::Node& item : list) {
    try {
      add(item);
    } catch (const std::invalid_argument& error) {
      throw YamlError(item.Mark(), error.what());
    }
  }
}

/// Returns parse(root node of the text).
/// @param path for error messages
/// @throws std::runtime_error "path:line: reason"
template <typename Parse>
auto parseYaml(const std::string& text, const std::string& path, Parse parse) {
  try {
    return parse(YAML::Load(text));
  } catch (const YamlError& error) {
    throw std::runtime_error(path + ":" + std::to_string(error.line) + ": " + error.what());
  } catch (const YAML::Exception& error) {
    throw std::runtime_error(path + ":" + std::to_string(error.mark.line + 1) + ": " + error.msg);
  }
}

}  // namespace sextant
