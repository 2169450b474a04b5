// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>

#include "sextant/base/params.hpp"

namespace sextant {

/// Reads the private parameters of a node; those that are not set keep their values. A wrong type or an
/// unknown name is an error: roscpp's own param() would silently keep the default. A whole number is taken
/// where a real one is expected.
/// @throws std::invalid_argument with the full name and what is allowed
void readParams(const ros::NodeHandle& private_node, const ParamList& params);

/// @throws std::invalid_argument that begins with the full name of the first parameter out of range
void requireAllowed(const ros::NodeHandle& private_node, const ParamList& params);

template <typename Params>
Params readParams(const ros::NodeHandle& private_node) {
  Params params;
  readParams(private_node, params.fields());
  // Anew: a range may depend on another value.
  requireAllowed(private_node, params.fields());
  return params;
}

}  // namespace sextant
