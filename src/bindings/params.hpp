// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include "sextant/base/params.hpp"

namespace sextant {

pybind11::object valueOf(const Param& param);
/// Sets a parameter. @throws pybind11::type_error with the name of the parameter
void setValue(const Param& param, const pybind11::handle& value);
/// Returns a list of (name, type, allowed values, unit, description).
pybind11::list describe(const ParamList& params);

/// Binds a struct of parameters: an attribute for each parameter, validate(), and fields(), which describes
/// them.
template <typename Params>
pybind11::class_<Params> bindParams(pybind11::module_& module, const char* name, const char* doc = "") {
  pybind11::class_<Params> bound(module, name, doc);
  bound.def(pybind11::init<>())
      .def(
          "validate", [](const Params& self) { validate(self); }, "ValueError for a parameter out of range.")
      .def_static(
          "fields", [] { return describe(Params().fields()); },
          "List of (name, type, allowed values, unit, description) of all parameters.");
  Params params;
  const ParamList fields = params.fields();
  for (size_t i = 0; i < fields.size(); ++i)
    bound.def_property(
        fields[i].name.c_str(), [i](Params& self) { return valueOf(self.fields()[i]); },
        [i](Params& self, const pybind11::object& value) { setValue(self.fields()[i], value); },
        fields[i].description);
  return bound;
}

}  // namespace sextant
