// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "params.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>

namespace py = pybind11;

namespace sextant {
namespace {

void set(const Numbers& numbers, const py::handle& value) {
  const auto given = py::cast<std::vector<double>>(value);
  if (given.size() != numbers.count) throw py::cast_error();
  std::copy(given.begin(), given.end(), numbers.first);
}

template <typename T>
void set(T* target, const py::handle& value) {
  *target = py::cast<T>(value);
}

py::object get(const Numbers& numbers) {
  return py::array_t<double>(static_cast<py::ssize_t>(numbers.count), numbers.first);
}

template <typename T>
py::object get(const T* source) {
  return py::cast(*source);
}

}  // namespace

py::object valueOf(const Param& param) {
  return std::visit([](const auto& value) { return get(value); }, param.value);
}

void setValue(const Param& param, const py::handle& value) {
  try {
    std::visit([&](const auto& target) { set(target, value); }, param.value);
  } catch (const py::cast_error&) {
    const std::string given = py::repr(value);
    throw py::type_error(param.name + " must be " + typeName(param.value) + ", not " + given);
  }
}

py::list describe(const ParamList& params) {
  py::list all;
  for (const Param& param : params)
    all.append(
        py::make_tuple(param.name, typeName(param.value), param.allowed.text, param.unit, param.description));
  return all;
}

}  // namespace sextant
