// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_slam.hpp"

#include "bindings.hpp"
#include "casters.hpp"
#include "plane_casters.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {

namespace {

void bindParams(py::module_& module) {
  py::class_<AssociationParams>(module, "AssociationParams",
                                "How sightings are told to be of known landmarks.")
      .def(py::init<>())
      .def_readwrite("mode", &AssociationParams::mode)
      .def_readwrite("gate", &AssociationParams::gate)
      .def_readwrite("doubt", &AssociationParams::doubt)
      .def_readwrite("margin", &AssociationParams::margin)
      .def_readwrite("density", &AssociationParams::density)
      .def_readwrite("new_margin", &AssociationParams::new_margin)
      .def_readwrite("nearest_distance", &AssociationParams::nearest_distance)
      .def_readwrite("effort", &AssociationParams::effort)
      .def("validate", &AssociationParams::validate);
  py::class_<CandidateParams>(module, "CandidateParams",
                              "When something that is seen is taken for a landmark.")
      .def(py::init<>())
      .def_readwrite("gate", &CandidateParams::gate)
      .def_readwrite("sightings", &CandidateParams::sightings)
      .def_readwrite("memory", &CandidateParams::memory)
      .def("validate", &CandidateParams::validate);
}

void bindSensorParams(py::module_& module) {
  py::class_<LandmarkSensorParams>(module, "LandmarkSensorParams", "What a sensor sees, and how surely.")
      .def(py::init<>())
      .def_readwrite("max_range", &LandmarkSensorParams::max_range)
      .def_readwrite("min_range", &LandmarkSensorParams::min_range)
      .def_readwrite("field_of_view", &LandmarkSensorParams::field_of_view)
      .def_readwrite("detection", &LandmarkSensorParams::detection)
      .def_readwrite("phantom", &LandmarkSensorParams::phantom)
      .def_readwrite("width", &LandmarkSensorParams::width)
      .def_readwrite("separation", &LandmarkSensorParams::separation)
      .def("validate", &LandmarkSensorParams::validate);
  py::class_<LandmarkMatchingParams>(module, "LandmarkMatchingParams",
                                     "How a lost robot finds itself in a map.")
      .def(py::init<>())
      .def_readwrite("gate", &LandmarkMatchingParams::gate)
      .def_readwrite("certainty", &LandmarkMatchingParams::certainty)
      .def_readwrite("present", &LandmarkMatchingParams::present)
      .def("validate", &LandmarkMatchingParams::validate);
}

void bindSlamParams(py::module_& module) {
  py::class_<LandmarkSlamParams>(module, "LandmarkSlamParams")
      .def(py::init<>())
      .def_readwrite("filter", &LandmarkSlamParams::filter)
      .def_readwrite("association", &LandmarkSlamParams::association)
      .def_readwrite("candidates", &LandmarkSlamParams::candidates)
      .def_readwrite("sensor", &LandmarkSlamParams::sensor)
      .def_readwrite("matching", &LandmarkSlamParams::matching)
      .def_readwrite("lost_after", &LandmarkSlamParams::lost_after)
      .def_readwrite("read_only", &LandmarkSlamParams::read_only)
      .def("validate", &LandmarkSlamParams::validate);
}

void bindReport(py::module_& module) {
  py::class_<LandmarkReport>(module, "LandmarkReport", "What became of the sightings of a moment.")
      .def_readonly("known", &LandmarkReport::known)
      .def_readonly("begun", &LandmarkReport::begun)
      .def_readonly("doubtful", &LandmarkReport::doubtful)
      .def_readonly("waiting", &LandmarkReport::waiting)
      .def_readonly("rejected", &LandmarkReport::rejected)
      .def_readonly("merged", &LandmarkReport::merged)
      .def_readonly("removed", &LandmarkReport::removed)
      .def_readonly("lost", &LandmarkReport::lost)
      .def_readonly("nis", &LandmarkReport::nis)
      .def_readonly("nis_width", &LandmarkReport::nis_width)
      .def_readonly("keys", &LandmarkReport::keys, "key of each sighting's landmark, or None");
}

}  // namespace

void bindLandmarkSlam(py::module_& module) {
  bindParams(module);
  bindSensorParams(module);
  bindSlamParams(module);
  bindReport(module);
  py::class_<LandmarkSlam>(module, "LandmarkSlam",
                           "Localization and mapping with landmarks that come, are found to be one, and go.")
      .def(py::init<const LandmarkSlamParams&, const Pose2&, const Eigen::Matrix3d&>(), "params"_a, "pose"_a,
           "covariance"_a, "pose (3,); covariance (3, 3) of it, map's axes, positive definite")
      .def(py::init<const LandmarkSlam&>(), "other"_a)
      .def(
          "predict",
          [](LandmarkSlam& self, const Pose2& step, const Eigen::Matrix3d& noise, double duration) {
            self.predict({step, noise, step.position.norm()}, duration);
          },
          "step"_a, "noise"_a, "duration"_a = 0.0, "as LandmarkFilter.predict()")
      .def("see", &LandmarkSlam::see, "stamp"_a, "sightings"_a, "T_base_sensor"_a = Pose2{},
           "LandmarkReport of all LabelledSighting of one moment, seconds")
      .def_property_readonly("filter", &LandmarkSlam::filter, py::return_value_policy::reference_internal)
      .def_property_readonly("labels", &LandmarkSlam::labels,
                             "LandmarkLabel of each of the filter's landmarks")
      .def_property_readonly("keys", &LandmarkSlam::keys, "a number of each, the same as long as it lives")
      .def_property_readonly("candidates", &LandmarkSlam::candidates, "number of what may become landmarks")
      .def_property_readonly("is_lost", &LandmarkSlam::isLost)
      .def("lose", &LandmarkSlam::lose, "where the robot is is not known any more")
      .def("set_pose", &LandmarkSlam::setPose, "pose"_a, "covariance"_a)
      .def("set_map", &LandmarkSlam::setMap, "pose"_a, "landmarks"_a, "labels"_a, "covariance"_a,
           "covariance (n, n) of x, y, heading of the robot and then x, y[, heading] of the landmarks");
}

}  // namespace sextant
