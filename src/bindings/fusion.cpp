// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include "marker_casters.hpp"
#include "params.hpp"
#include "pose_casters.hpp"
#include "sextant/fusion/landmark_session.hpp"
#include "sextant/fusion/marker_landmarks.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {
namespace {

void bindMarkerLandmarks(py::module_& module) {
  bindParams<MarkerLandmarkParams>(module, "MarkerLandmarkParams",
                                   "Parameters of the conversion of printed markers to planar landmarks.");
  bindParams<LandmarkSlamNodeParams>(module, "LandmarkSlamNodeParams",
                                     "Parameters of the nodelet sextant/LandmarkSlam.")
      .def_readwrite("slam", &LandmarkSlamNodeParams::slam, "LandmarkSlamParams")
      .def_readwrite("timeline", &LandmarkSlamNodeParams::timeline, "LandmarkTimelineParams")
      .def_readwrite("markers", &LandmarkSlamNodeParams::markers, "MarkerLandmarkParams")
      .def_property_readonly("first_pose", &LandmarkSlamNodeParams::startPose,
                             "(3,) x, y, heading of start_pose in the map")
      .def_property_readonly("first_covariance", &LandmarkSlamNodeParams::startCovariance,
                             "(3, 3) of first_pose, from pose_sigma");
  py::class_<SeenMarker>(module, "SeenMarker", "A detected marker with its pose.")
      .def(py::init([](const std::string& family, int id, const Pose& T_camera_marker,
                       const Matrix6d& covariance, double alternative_probability) {
             return SeenMarker{{family, id}, T_camera_marker, covariance, alternative_probability};
           }),
           "family"_a, "id"_a, "T_camera_marker"_a, "covariance"_a, "alternative_probability"_a = 0.0,
           "T_camera_marker (4, 4); covariance (6, 6) of position and rotation in the axes of the optical "
           "frame; probability that the alternative pose is the true one");
  module.def("marker_observations", &markerObservations, "markers"_a, "T_base_camera"_a, "params"_a,
             "map"_a = nullptr,
             "LabelledObservation of each SeenMarker of an image in the robot frame; T_base_camera (4, 4); "
             "MarkerMap whose markers measure the slope below the robot (ramp_sigma), or None");
  module.def("alternative_pose_probability", &alternativePoseProbability, "error"_a, "alternative_error"_a,
             "sigma"_a,
             "Probability that the worse one of the two poses of a marker is the true one; RMS reprojection "
             "errors and "
             "corner noise in pixels");
  module.def(
      "marker_landmarks",
      [](const MarkerMap& map) {
        const MarkerLandmarks found = landmarksOf(map);
        return py::make_tuple(found.landmarks, found.labels, found.covariances);
      },
      "marker_map"_a,
      "Landmark2D, LandmarkLabel and covariance (3, 3) of x, y, heading of each marker of a map, as three "
      "lists");
}

void bindLandmarkSession(py::module_& module) {
  py::class_<LandmarkSession>(module, "LandmarkSession",
                              "Landmark SLAM with map files, as the nodelet sextant/LandmarkSlam runs it.")
      .def(py::init<const LandmarkSlamNodeParams&>(), "params"_a,
           "ValueError, RuntimeError: a map file of the parameters cannot be read")
      .def_property_readonly("timeline", &LandmarkSession::timeline,
                             py::return_value_policy::reference_internal, "LandmarkTimeline")
      .def_property_readonly("map", &LandmarkSession::map, "current LandmarkMap, as save() writes it")
      .def("restart", &LandmarkSession::restart, "Restarts odometry and keeps the map; the robot is lost")
      .def("save", &LandmarkSession::save, "file"_a = "",
           "Writes the map to a file, by default map_file, and returns the absolute path");
}

}  // namespace
}  // namespace sextant

PYBIND11_MODULE(fusion, module) {
  module.doc() = "Printed markers as landmarks in the plane.";
  py::module_::import("sextant._core.markers");
  py::module_::import("sextant._core.landmarks");
  sextant::bindMarkerLandmarks(module);
  sextant::bindLandmarkSession(module);
}
