// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_map_file.hpp"

#include "bindings.hpp"
#include "casters.hpp"
#include "plane_casters.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {

void bindLandmarkMapFile(py::module_& module) {
  py::class_<LandmarkMap>(module, "LandmarkMap",
                          "Landmarks with all that is known of them, and of where the robot was.")
      .def(py::init([](const std::string& frame, const Pose2& pose,
                       const std::vector<PlaneLandmark>& landmarks, const std::vector<LandmarkLabel>& labels,
                       const Eigen::MatrixXd& covariance, bool is_lost) {
             LandmarkMap map{frame, pose, landmarks, labels, covariance, is_lost};
             map.validate();
             return map;
           }),
           "frame"_a, "pose"_a, "landmarks"_a, "labels"_a, "covariance"_a, "is_lost"_a = false)
      .def_readonly("frame", &LandmarkMap::frame)
      .def_readonly("pose", &LandmarkMap::T_map_base, "(3,) of the robot")
      .def_readonly("landmarks", &LandmarkMap::landmarks)
      .def_readonly("labels", &LandmarkMap::labels)
      .def_readonly("covariance", &LandmarkMap::covariance,
                    "(n, n) of the robot's x, y, heading, then the landmarks'")
      .def_readonly("is_lost", &LandmarkMap::is_lost, "the robot is not where pose says");
  module.def("read_landmark_map", &readLandmarkMap, "path"_a);
  module.def("write_landmark_map", &writeLandmarkMap, "landmark_map"_a, "path"_a);
}

}  // namespace sextant
