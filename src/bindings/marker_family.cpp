// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/marker_family.hpp"

#include "bindings.hpp"
#include "casters.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {

void bindMarkerFamily(py::module_& module) {
  module.def("marker_families", &markerFamilies, "Every family name that detectors and maps take.");
  module.def("canonical_family", &canonicalFamily, "name"_a, "One name per print.");
  module.def("family_size", &familySize, "name"_a, "Number of different markers in a family.");
  module.def(
      "marker_image",
      [](const std::string& family, int id) {
        const MarkerImage image = markerImage(family, id);
        return py::make_tuple(arrayFromImage(image.modules), image.border_begin, image.border_end);
      },
      "family"_a, "id"_a,
      "(modules, begin, end): uint8 picture, one pixel a module, and the rows and columns that the marker's "
      "size spans.");
}

}  // namespace sextant
