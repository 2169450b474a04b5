// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/base/param_reader.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace sextant {
namespace {

// Read by nodelet in the private namespace of the node.
const char* const kForeign = "num_worker_threads";

// The parameter server stores a name with a slash, "tag36h11/5", as a table in a table.
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

bool isId(const std::string& name) {
  return !name.empty() && name.size() <= 9 && name.find_first_not_of("0123456789") == std::string::npos;
}

/// Reads one parameter that is set.
struct Reader {
  const ros::NodeHandle& node;
  const Param& param;

  void operator()(bool* value) const { get(*value, "true or false"); }
  void operator()(double* value) const { get(*value, "a number"); }
  void operator()(std::vector<std::string>* value) const { get(*value, "a list of strings"); }
  void operator()(std::vector<double>* value) const { get(*value, "a list of numbers"); }
  void operator()(std::map<std::string, std::string>* value) const {
    get(*value, "a table of names and texts");
  }
  void operator()(int* value) const {
    double number = 0;
    get(number, "a whole number");
    if (!(std::abs(number) <= std::numeric_limits<int>::max()) || number != std::trunc(number))
      refuse("a whole number");
    *value = static_cast<int>(number);
  }
  void operator()(std::string* value) const {
    int number = 0;
    if (param.may_be_number && node.getParam(param.name, number))
      *value = std::to_string(number);
    else
      get(*value, "a text");
  }
  void operator()(std::map<std::string, double>* value) const {
    XmlRpc::XmlRpcValue table;
    get(table, "a table of names and numbers");
    value->clear();
    if (!flatten(table, "", *value)) refuse("a table of names and numbers");
  }
  // The parameter server has no tables with numbers as names, so ids are texts.
  void operator()(std::map<int, double>* value) const {
    std::map<std::string, double> named;
    (*this)(&named);
    value->clear();
    for (const auto& [name, number] : named) {
      if (!isId(name))
        throw std::invalid_argument("parameter " + node.resolveName(param.name) + ": '" + name +
                                    "' is not a marker id");
      (*value)[std::stoi(name)] = number;
    }
  }
  void operator()(const Numbers&) const {
    throw std::logic_error(param.name + " is not a parameter of a node");
  }

  template <typename T>
  void get(T& value, const char* type) const {
    if (!node.getParam(param.name, value)) refuse(type);
  }
  [[noreturn]] void refuse(const char* type) const {
    throw std::invalid_argument("parameter " + node.resolveName(param.name) + " must be " + type);
  }
};

void rejectUnknown(const ros::NodeHandle& node, const ParamList& params) {
  std::vector<std::string> set;
  node.getParamNames(set);
  const std::string prefix = node.getNamespace() + "/";
  std::string known;
  for (const Param& param : params) known += " " + param.name;
  for (const auto& full : set) {
    if (full.compare(0, prefix.size(), prefix) != 0) continue;
    const std::string name = full.substr(prefix.size(), full.find('/', prefix.size()) - prefix.size());
    const auto is_it = [&](const Param& param) { return param.name == name; };
    if (name != kForeign && std::none_of(params.begin(), params.end(), is_it))
      throw std::invalid_argument("unknown parameter " + full + "; known are" + known);
  }
}

}  // namespace

namespace detail {

void readUnchecked(const ros::NodeHandle& private_node, const ParamList& params) {
  for (const Param& param : params)
    if (private_node.hasParam(param.name)) std::visit(Reader{private_node, param}, param.value);
  rejectUnknown(private_node, params);
}

void requireAllowed(const ros::NodeHandle& private_node, const ParamList& params) {
  try {
    sextant::requireAllowed(params);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("parameter " + private_node.getNamespace() + "/" + error.what());
  }
}

}  // namespace detail
}  // namespace sextant
