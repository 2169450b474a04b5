// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dynamic_reconfigure/Config.h>

#include "sextant/base/params.hpp"

namespace sextant {

/// Sets the parameters that the message names.
void setParams(const ParamList& params, const dynamic_reconfigure::Config& message);
/// Sets every value of the message from the parameter with the same name.
void fillMessage(dynamic_reconfigure::Config& message, const ParamList& params);

/// Returns the dynamic_reconfigure values of a node's parameters.
template <typename Config, typename Params>
Config toConfig(Params params) {
  Config config = Config::__getDefault__();
  dynamic_reconfigure::Config message;
  config.__toMessage__(message);
  fillMessage(message, params.fields());
  config.__fromMessage__(message);
  return config;
}

/// Returns params with the values of config.
/// @throws std::invalid_argument with the name of the first value out of range
template <typename Config, typename Params>
Params withConfig(Params params, const Config& config) {
  dynamic_reconfigure::Config message;
  config.__toMessage__(message);
  setParams(params.fields(), message);
  validate(params);
  return params;
}

}  // namespace sextant
