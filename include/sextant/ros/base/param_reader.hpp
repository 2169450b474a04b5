// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>

#include "sextant/base/params.hpp"

// Names and types are checked here, ranges in base/params.hpp.
namespace sextant {

namespace detail {

/// Reads the parameters that are set, and checks names and types, not values.
void readUnchecked(const ros::NodeHandle& private_node, const ParamList& params);

/// Checks the values of all parameters, as sextant::requireAllowed(), with the full name in the error
/// message.
void requireAllowed(const ros::NodeHandle& private_node, const ParamList& params);

}  // namespace detail

/// Reads and checks the private parameters of a node; a parameter that is not set keeps its value. A wrong
/// type or an unknown name is an error, where roscpp's param() would silently keep the default. An integer is
/// accepted for a real number.
/// @throws std::invalid_argument with the full name, and the allowed type or values
template <typename Params>
Params readParams(const ros::NodeHandle& private_node) {
  Params params;
  detail::readUnchecked(private_node, params.fields());
  // A new list, because a range may depend on another value.
  detail::requireAllowed(private_node, params.fields());
  return params;
}

}  // namespace sextant
