// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/base/strict_yaml.hpp"

#include <cmath>

#include "sextant/base/decimal_text.hpp"

namespace sextant {

void requireKeys(const YAML::Node& node, const std::string& what, const std::set<std::string>& required,
                 const std::set<std::string>& optional) {
  if (!node.IsMap()) throw YamlError(node.Mark(), what + " must be a table of names and values");
  std::set<std::string> keys;
  for (const auto& item : node) {
    const std::string key = item.first.Scalar();
    if (required.count(key) + optional.count(key) == 0)
      throw YamlError(item.first.Mark(), "unknown name '" + key + "' in " + what);
    if (!keys.insert(key).second) throw YamlError(item.first.Mark(), "'" + key + "' is given twice");
  }
  for (const std::string& key : required)
    if (keys.count(key) == 0) throw YamlError(node.Mark(), what + " lacks '" + key + "'");
}

double number(const YAML::Node& node) {
  double value = NAN;
  if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !std::isfinite(value))
    throw YamlError(node.Mark(),
                    "needs a finite number" + (node.IsScalar() ? ", not '" + node.Scalar() + "'" : ""));
  return value;
}

int wholeNumber(const YAML::Node& node) {
  int value = 0;
  if (!node.IsScalar() || !YAML::convert<int>::decode(node, value))
    throw YamlError(node.Mark(), "needs a whole number");
  return value;
}

bool boolean(const YAML::Node& node) {
  bool value = false;
  if (!node.IsScalar() || !YAML::convert<bool>::decode(node, value))
    throw YamlError(node.Mark(), "needs true or false");
  return value;
}

std::string nonEmptyText(const YAML::Node& node) {
  if (!node.IsScalar() || node.Scalar().empty())
    throw YamlError(node.Mark(), "needs a text that is not empty");
  return node.Scalar();
}

Eigen::VectorXd numbers(const YAML::Node& node, size_t count) {
  if (!node.IsSequence() || node.size() != count)
    throw YamlError(node.Mark(), "needs a list of " + std::to_string(count) + " numbers");
  Eigen::VectorXd values(count);
  for (size_t i = 0; i < count; ++i) values[i] = number(node[i]);
  return values;
}

std::string listText(const double* values, size_t count) {
  std::string text = "[";
  for (size_t i = 0; i < count; ++i) text += (i ? ", " : "") + shortestDecimal(values[i]);
  return text + "]";
}

std::string quotedText(const std::string& text) {
  YAML::Emitter out;
  out << YAML::DoubleQuoted << text;
  return out.c_str();
}

}  // namespace sextant
