// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include "sextant/base/params.hpp"

namespace sextant {

pybind11::object valueOf(const Param& param);
/// @throws pybind11::type_error that names the parameter
void setValue(const Param& param, const pybind11::handle& value);
/// [(name, type, what is allowed, unit, description)]
pybind11::list describe(const ParamList& params);

/// A struct of parameters: an attribute for each by its name in fields(), which describes them, and
/// validate().
template <typename Params>
pybind11::class_<Params> bindParams(pybind11::module_& module, const char* name, const char* doc = "") {
  pybind11::class_<Params> bound(module, name, doc);
  bound.def(pybind11::init<>())
      .def("validate", [](const Params& self) { validate(self); })
      .def_static("fields", [] { return describe(Params().fields()); });
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
