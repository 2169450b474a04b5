// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/places/descriptor_index.hpp"

#include "bindings.hpp"
#include "casters.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {
namespace {

template <class T>
py::array_t<T> table(const std::vector<T>& values, int columns) {
  return py::array_t<T>({static_cast<py::ssize_t>(values.size()) / columns, py::ssize_t{columns}},
                        values.data());
}

py::tuple search(const DescriptorIndex& index, const py::array& descriptors, int k) {
  const cv::Mat matrix = matrixFromArray(descriptors);
  Neighbours found;
  {
    py::gil_scoped_release release;
    found = index.search(matrix, k);
  }
  return py::make_tuple(table(found.distances, k), table(found.owners, k), table(found.rows, k));
}

}  // namespace

void bindDescriptorIndex(py::module_& module) {
  py::class_<DescriptorIndex>(module, "DescriptorIndex",
                              "Descriptors of many pictures, searched by nearness.")
      .def(py::init([](const std::string& matcher, const py::array& samples, int64_t expected) {
             const cv::Mat matrix = matrixFromArray(samples);
             const py::gil_scoped_release others;
             return makeDescriptorIndex(matcher, matrix, expected);
           }),
           "matcher"_a, "samples"_a, "expected"_a)
      .def_static("read", &readDescriptorIndex, "path"_a, "offset"_a,
                  py::call_guard<py::gil_scoped_release>())
      .def(
          "add",
          [](DescriptorIndex& index, int32_t owner, const py::array& descriptors) {
            const cv::Mat matrix = matrixFromArray(descriptors);
            const py::gil_scoped_release others;
            index.add(owner, matrix);
          },
          "owner"_a, "descriptors"_a)
      .def("remove", &DescriptorIndex::remove, "owner"_a, py::call_guard<py::gil_scoped_release>())
      .def("search", &search, "descriptors"_a, "k"_a,
           "(distances, owners, rows), each (n, k), nearest first; owner -1, infinitely far: no more.")
      .def_property_readonly("bytes", &DescriptorIndex::bytes)
      .def("append", &DescriptorIndex::append, "path"_a, py::call_guard<py::gil_scoped_release>())
      .def("__len__", &DescriptorIndex::size);
  module.def("matcher_names", &matcherNames);
  module.def("validate_matcher", &validateMatcher, "matcher"_a, "extractor"_a, "orb_wta_k"_a);
}

}  // namespace sextant
