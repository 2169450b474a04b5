// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/marker.hpp"

#include "bindings.hpp"
#include "casters.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {

void bindMarker(py::module_& module) {
  py::class_<Detection>(module, "Detection", "A marker found in an image.")
      .def(py::init([](const std::string& family, int id, const Corners& corners) {
             Detection detection;
             detection.key = {family, id};
             detection.corners = corners;
             return detection;
           }),
           "family"_a, "id"_a, "corners"_a)
      .def_property_readonly("family", [](const Detection& detection) { return detection.key.family; })
      .def_property_readonly("id", [](const Detection& detection) { return detection.key.id; })
      .def_readwrite("corners", &Detection::corners)
      .def_readwrite("corner_sigmas", &Detection::corner_sigmas,
                     "Four standard deviations of a corner's coordinates, pixels; -1: unknown.")
      .def_readonly("hamming", &Detection::hamming)
      .def_readonly("decision_margin", &Detection::decision_margin);
  module.def(
      "marker_corners",
      [](double size) {
        Eigen::Matrix<double, 4, 3> corners;
        for (int i = 0; i < 4; ++i) corners.row(i) = markerCorners(size)[i];
        return corners;
      },
      "size"_a,
      "Corners (4 x 3, metres) in the marker's frame: top left, top right, bottom right, bottom left.");
}

}  // namespace sextant
