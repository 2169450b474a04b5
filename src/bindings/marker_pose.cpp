// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/marker_pose.hpp"

#include "bindings.hpp"
#include "casters.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {

void bindMarkerPose(py::module_& module) {
  py::class_<MarkerPose>(module, "MarkerPose")
      .def_readonly("T_camera_marker", &MarkerPose::T_camera_marker)
      .def_readonly("reprojection_error", &MarkerPose::reprojection_error, "RMS, pixels");
  py::class_<PlanarPoses>(module, "PlanarPoses", "Both poses that explain a square's four corners.")
      .def_readonly("best", &PlanarPoses::best)
      .def_readonly("alternative", &PlanarPoses::alternative)
      .def_property_readonly("ambiguity", &PlanarPoses::ambiguity);
  module.def("solve_marker_pose", &solveMarkerPose, "camera"_a, "corners"_a, "size"_a,
             "PlanarPoses of a marker with this edge length in metres, or None.");
  module.def(
      "marker_pose_covariance", &markerPoseCovariance, "camera"_a, "T_camera_marker"_a, "size"_a, "sigma"_a,
      "6 x 6, position and rotation in the optical frame's axes, from sigma pixels of noise; or None.");
}

}  // namespace sextant
