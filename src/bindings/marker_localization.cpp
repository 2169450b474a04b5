// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/marker_localization.hpp"

#include "bindings.hpp"
#include "casters.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {

void bindMarkerLocalization(py::module_& module) {
  py::class_<OdometryParams>(module, "OdometryParams")
      .def(py::init<>())
      .def_readwrite("position_drift", &OdometryParams::position_drift)
      .def_readwrite("heading_drift", &OdometryParams::heading_drift)
      .def_readwrite("turn_drift", &OdometryParams::turn_drift)
      .def_readwrite("gate", &OdometryParams::gate)
      .def_readwrite("recovery", &OdometryParams::recovery)
      .def("validate", &OdometryParams::validate);
  py::class_<LocalizationParams>(module, "LocalizationParams")
      .def(py::init<>())
      .def_readwrite("locator", &LocalizationParams::locator)
      .def_readwrite("odometry", &LocalizationParams::odometry)
      .def_readwrite("estimate_noise", &LocalizationParams::estimate_noise)
      .def_readwrite("leave_out_moved", &LocalizationParams::leave_out_moved)
      .def("validate", &LocalizationParams::validate);
  py::class_<MovedMarker>(module, "MovedMarker", "A marker that does not stand where the map has it.")
      .def_property_readonly("family", [](const MovedMarker& marker) { return marker.key.family; })
      .def_property_readonly("id", [](const MovedMarker& marker) { return marker.key.id; })
      .def_readonly("offset", &MovedMarker::offset, "where it is seen minus where the map has it, metres")
      .def_readonly("images", &MovedMarker::images, "in which it was seen elsewhere");
  py::class_<MarkerLocalization>(module, "MarkerLocalization",
                                 "Locates a robot image by image: what the locator node does, without ROS.")
      .def(py::init<const LocalizationParams&>(), "params"_a = LocalizationParams())
      .def_property("params", &MarkerLocalization::params, &MarkerLocalization::setParams)
      .def("locate", &MarkerLocalization::locate, "map"_a, "views"_a, "T_odom_base"_a = py::none(),
           "LocatorResult; views: MarkerView of one instant, one a camera.")
      .def_property_readonly(
          "T_map_odom", [](const MarkerLocalization& self) { return self.correction().transform(); },
          "4 x 4, or None before the first pose with odometry")
      .def_property_readonly("moved", [](const MarkerLocalization& self) { return self.watch().moved(); })
      .def(
          "noise_scale",
          [](const MarkerLocalization& self, size_t camera) { return self.noise().typical(camera); },
          "camera"_a = 0, "factor on corner_sigma of most images of this camera, by their residuals")
      .def("reset", &MarkerLocalization::reset,
           "Forgets everything: another map, or a clock that jumped back.");
}

}  // namespace sextant
