// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dynamic_reconfigure/Config.h>

#include "sextant/base/params.hpp"

namespace sextant {

/// Takes the values of the message into the parameters of their names.
void setParams(const ParamList& params, const dynamic_reconfigure::Config& message);
/// Takes the values of the parameters into the message's entries of their names.
void fillMessage(dynamic_reconfigure::Config& message, const ParamList& params);

/// Those of a node's parameters that may change while it runs.
template <typename Config, typename Params>
Config toConfig(Params params) {
  Config config = Config::__getDefault__();
  dynamic_reconfigure::Config message;
  config.__toMessage__(message);
  fillMessage(message, params.fields());
  config.__fromMessage__(message);
  return config;
}

/// @return params with the values of config
/// @throws std::invalid_argument that names the first value out of range
template <typename Config, typename Params>
Params withConfig(Params params, const Config& config) {
  dynamic_reconfigure::Config message;
  config.__toMessage__(message);
  setParams(params.fields(), message);
  validate(params);
  return params;
}

}  // namespace sextant
