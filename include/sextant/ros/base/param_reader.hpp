// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>

#include "sextant/base/params.hpp"

namespace sextant {

/// Reads the private parameters of a node; a parameter that is not set keeps its value. A wrong type or an
/// unknown name is an error, where roscpp's param() would silently keep the default. An integer is accepted
/// for a real number.
/// @throws std::invalid_argument with the full name and the allowed type
void readParams(const ros::NodeHandle& private_node, const ParamList& params);

/// Checks the values of all parameters.
/// @throws std::invalid_argument with the full name of the first parameter out of range
void requireAllowed(const ros::NodeHandle& private_node, const ParamList& params);

/// Reads and checks the private parameters of a node. @throws as the two functions above

template <typename Params>
Params readParams(const ros::NodeHandle& private_node) {
  Params params;
  readParams(private_node, params.fields());
  // A new list, because a range may depend on another value.
  requireAllowed(private_node, params.fields());
  return params;
}

}  // namespace sextant
