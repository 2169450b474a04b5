// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/base/param_reader.hpp"

#include <ros/names.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace sextant {
namespace {

// Read by libraries in the node's private namespace, not by us.
const std::set<std::string>& foreign() {
  static const std::set<std::string> names = {"num_worker_threads"};
  return names;
}

// A name with a slash, "tag36h11/5", is a table in a table on the parameter server.
bool flatten(const XmlRpc::XmlRpcValue& table, const std::string& prefix,
             std::map<std::string, double>& out) {
  using XmlRpc::XmlRpcValue;
  if (table.getType() != XmlRpcValue::TypeStruct) return false;
  for (const auto& [name, value] : table) {
    if (value.getType() == XmlRpcValue::TypeInt)
      out[prefix + name] = static_cast<const int&>(value);
    else if (value.getType() == XmlRpcValue::TypeDouble)
      out[prefix + name] = static_cast<const double&>(value);
    else if (!flatten(value, prefix + name + "/", out))
      return false;
  }
  return true;
}

}  // namespace

template <typename T>
void ParamReader::readAs(const std::string& name, T& value, const char* type) {
  known_.insert(name);
  if (node_.hasParam(name) && !node_.getParam(name, value))
    throw std::invalid_argument("parameter " + node_.resolveName(name) + " must be " + type);
}

void ParamReader::read(const std::string& name, bool& value) { readAs(name, value, "true or false"); }
void ParamReader::read(const std::string& name, int& value) {
  double number = value;
  readAs(name, number, "a whole number");
  if (!(std::abs(number) <= std::numeric_limits<int>::max()) || number != std::trunc(number))
    throw std::invalid_argument("parameter " + node_.resolveName(name) + " must be a whole number");
  value = static_cast<int>(number);
}
void ParamReader::read(const std::string& name, double& value) { readAs(name, value, "a number"); }
void ParamReader::read(const std::string& name, std::string& value) { readAs(name, value, "a text"); }
void ParamReader::read(const std::string& name, std::vector<std::string>& value) {
  readAs(name, value, "a list of texts");
}
void ParamReader::read(const std::string& name, std::vector<double>& value) {
  readAs(name, value, "a list of numbers");
}
void ParamReader::read(const std::string& name, std::map<std::string, double>& value) {
  const char* type = "a table of names and numbers";
  XmlRpc::XmlRpcValue table;
  readAs(name, table, type);
  if (!table.valid()) return;
  value.clear();
  if (!flatten(table, "", value))
    throw std::invalid_argument("parameter " + node_.resolveName(name) + " must be " + type);
}
void ParamReader::read(const std::string& name, std::map<std::string, std::string>& value) {
  readAs(name, value, "a table of names and texts");
}

void ParamReader::readWord(const std::string& name, std::string& value) {
  int number = 0;
  if (!node_.getParam(name, number)) return read(name, value);
  known_.insert(name);
  value = std::to_string(number);
}

void ParamReader::rejectUnknown() const {
  std::vector<std::string> set;
  node_.getParamNames(set);
  const std::string prefix = node_.getNamespace() + "/";
  std::string known;
  for (const auto& name : known_) known += " " + name;
  for (const auto& full : set) {
    if (full.compare(0, prefix.size(), prefix) != 0) continue;
    const std::string name = full.substr(prefix.size(), full.find('/', prefix.size()) - prefix.size());
    if (known_.count(name) == 0 && foreign().count(name) == 0)
      throw std::invalid_argument("unknown parameter " + full + "; known are" + known);
  }
}

void requireTopics(const std::string& name, const std::vector<std::string>& topics) {
  for (const std::string& topic : topics) {
    std::string reason = "it is empty";
    if (topic.empty() || !ros::names::validate(topic, reason))
      throw std::invalid_argument(name + ": '" + topic + "' is no topic: " + reason);
  }
}

}  // namespace sextant
