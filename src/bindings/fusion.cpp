// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include "marker_casters.hpp"
#include "params.hpp"
#include "pose_casters.hpp"
#include "sextant/fusion/landmark_slam_node_params.hpp"
#include "sextant/fusion/marker_landmarks.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {
namespace {

void bindMarkerLandmarks(py::module_& module) {
  bindParams<MarkerLandmarkParams>(module, "MarkerLandmarkParams",
                                   "How printed markers become landmarks of the plane.");
  bindParams<LandmarkSlamNodeParams>(module, "LandmarkSlamNodeParams", "Of the nodelet sextant/LandmarkSlam.")
      .def_readwrite("slam", &LandmarkSlamNodeParams::slam)
      .def_readwrite("timeline", &LandmarkSlamNodeParams::timeline)
      .def_readwrite("markers", &LandmarkSlamNodeParams::markers)
      .def_property_readonly("first_pose", &LandmarkSlamNodeParams::startPose,
                             "(3,) of start_pose: x, y, heading in the map")
      .def_property_readonly("first_covariance", &LandmarkSlamNodeParams::startCovariance, "(3, 3) of it");
  module.def(
      "marker_sighting",
      [](const std::string& family, int id, const Pose& T_base_camera, const Pose& T_camera_marker,
         const Matrix6d& covariance, double other, const MarkerLandmarkParams& params) {
        return markerSighting({family, id}, T_base_camera, T_camera_marker, covariance, other, params);
      },
      "family"_a, "id"_a, "T_base_camera"_a, "T_camera_marker"_a, "covariance"_a, "other"_a, "params"_a,
      "LabelledSighting of a marker that a camera sees; covariance (6, 6): position, rotation in the optical "
      "frame's axes");
  module.def("probability_of_other", &probabilityOfOther, "error"_a, "other_error"_a, "sigma"_a,
             "that the worse of a marker's two poses is right; reprojection errors and noise in pixels");
  module.def(
      "marker_landmarks",
      [](const MarkerMap& map) {
        const MarkerLandmarks found = landmarksOf(map);
        return py::make_tuple(found.landmarks, found.labels, found.covariances);
      },
      "marker_map"_a, "landmarks, labels, and covariances (3, 3) of x, y, heading of a map of markers");
}

}  // namespace
}  // namespace sextant

PYBIND11_MODULE(fusion, module) {
  module.doc() = "Printed markers as landmarks in the plane.";
  py::module_::import("sextant._core.markers");
  py::module_::import("sextant._core.landmarks");
  sextant::bindMarkerLandmarks(module);
}
