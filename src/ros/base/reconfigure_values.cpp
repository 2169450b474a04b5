// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/base/reconfigure_values.hpp"

#include <algorithm>
#include <stdexcept>

namespace sextant {
namespace {

template <typename T>
T& valueOf(const ParamList& params, const std::string& name) {
  const auto found =
      std::find_if(params.begin(), params.end(), [&](const Param& param) { return param.name == name; });
  if (found == params.end()) throw std::logic_error("there is no parameter " + name);
  return *std::get<T*>(found->value);
}

// Calls assign(parameter's value, message's value) for each value of the message.
template <typename Message, typename Assign>
void pairUp(const ParamList& params, Message& message, Assign assign) {
  for (auto& each : message.bools) assign(valueOf<bool>(params, each.name), each.value);
  for (auto& each : message.ints) assign(valueOf<int>(params, each.name), each.value);
  for (auto& each : message.doubles) assign(valueOf<double>(params, each.name), each.value);
  for (auto& each : message.strs) assign(valueOf<std::string>(params, each.name), each.value);
}

}  // namespace

void setParams(const ParamList& params, const dynamic_reconfigure::Config& message) {
  pairUp(params, message, [](auto& value, const auto& of_message) { value = of_message; });
}

void fillMessage(dynamic_reconfigure::Config& message, const ParamList& params) {
  pairUp(params, message, [](const auto& value, auto& of_message) { of_message = value; });
}

}  // namespace sextant
