// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_timeline.hpp"

#include "bindings.hpp"
#include "casters.hpp"
#include "plane_casters.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {

namespace {

void bindParts(py::module_& module) {
  py::class_<LandmarkTimelineParams>(module, "LandmarkTimelineParams")
      .def(py::init<>())
      .def_readwrite("odometry", &LandmarkTimelineParams::odometry)
      .def_readwrite("lag", &LandmarkTimelineParams::lag)
      .def_readwrite("clock_offset", &LandmarkTimelineParams::clock_offset)
      .def("validate", &LandmarkTimelineParams::validate);
  py::enum_<Arrival>(module, "Arrival", "What became of sightings.")
      .value("TAKEN", Arrival::taken)
      .value("WAITING", Arrival::waiting, "for odometry of their moment")
      .value("TOO_LATE", Arrival::too_late)
      .value("DUPLICATE", Arrival::duplicate);
  py::class_<LandmarkTimeline::Applied>(module, "LandmarkApplied", "Sightings that came into the estimate.")
      .def_readonly("stamp", &LandmarkTimeline::Applied::stamp, "that they came with, seconds")
      .def_readonly("report", &LandmarkTimeline::Applied::report);
  py::class_<LandmarkTimeline::Now>(module, "LandmarkNow", "The robot at the last odometry.")
      .def_readonly("stamp", &LandmarkTimeline::Now::stamp, "seconds")
      .def_readonly("pose", &LandmarkTimeline::Now::T_map_base)
      .def_readonly("covariance", &LandmarkTimeline::Now::covariance, "(3, 3) of x, y, heading, map's axes")
      .def_readonly("T_map_odom", &LandmarkTimeline::Now::T_map_odom);
}

}  // namespace

void bindLandmarkTimeline(py::module_& module) {
  bindParts(module);
  py::class_<LandmarkTimeline>(
      module, "LandmarkTimeline",
      "Runs a LandmarkSlam on odometry and sightings that come late, twice, or out of order.")
      .def(py::init<const LandmarkTimelineParams&, const LandmarkSlam&>(), "params"_a, "slam"_a)
      .def("odometry", &LandmarkTimeline::odometry, "stamp"_a, "T_odom_base"_a,
           "False: it is not newer than the last one")
      .def("see", &LandmarkTimeline::see, "stamp"_a, "sightings"_a, "T_base_sensor"_a = Pose2{},
           "Arrival of what a sensor saw at one moment, in the robot frame")
      .def_property_readonly("now", &LandmarkTimeline::now, "LandmarkNow, or None before the first odometry")
      .def_property_readonly("slam", &LandmarkTimeline::slam, py::return_value_policy::copy,
                             "as it was after the newest sightings")
      .def_property_readonly("applied", &LandmarkTimeline::applied,
                             "[LandmarkApplied] that the last odometry() or see() brought in")
      .def_property_readonly("leaps", &LandmarkTimeline::leaps,
                             "how often odometry leapt farther than anything drives: it begins anew then")
      .def_property_readonly("is_lost", [](const LandmarkTimeline& self) { return self.slam().isLost(); })
      .def("lose", [](LandmarkTimeline& self) { self.change([](LandmarkSlam& slam) { slam.lose(); }); })
      .def(
          "set_pose",
          [](LandmarkTimeline& self, const Pose2& pose, const Eigen::Matrix3d& covariance) {
            self.change([&](LandmarkSlam& slam) { slam.setPose(pose, covariance); });
          },
          "pose"_a, "covariance"_a, "at the last odometry")
      .def(
          "set_map",
          [](LandmarkTimeline& self, const Pose2& pose, const std::vector<PlaneLandmark>& landmarks,
             const std::vector<LandmarkLabel>& labels, const Eigen::MatrixXd& covariance) {
            self.change([&](LandmarkSlam& slam) { slam.setMap(pose, landmarks, labels, covariance); });
          },
          "pose"_a, "landmarks"_a, "labels"_a, "covariance"_a)
      .def("restart", &LandmarkTimeline::restart,
           "odometry and all that was seen are forgotten, the map is not");
}

}  // namespace sextant
