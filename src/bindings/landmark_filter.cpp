// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_filter.hpp"

#include <pybind11/eigen.h>

#include "bindings.hpp"
#include "casters.hpp"
#include "plane_casters.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {
namespace {

void updateKnown(LandmarkFilter& self, const std::vector<size_t>& landmarks,
                 const std::vector<PlaneSighting>& sightings) {
  if (landmarks.size() != sightings.size()) throw std::invalid_argument("every sighting needs a landmark");
  std::vector<KnownSighting> seen;
  for (size_t i = 0; i < landmarks.size(); ++i) {
    if (landmarks[i] >= self.landmarks().size())
      throw py::index_error("there is no landmark " + std::to_string(landmarks[i]));
    seen.push_back({landmarks[i], sightings[i]});
  }
  self.update(seen);
}

void bindParams(py::module_& module) {
  py::class_<LandmarkFilterParams>(module, "LandmarkFilterParams")
      .def(py::init<>())
      .def_readwrite("form", &LandmarkFilterParams::form)
      .def_readwrite("sigma_points", &LandmarkFilterParams::sigma_points)
      .def_readwrite("init", &LandmarkFilterParams::init)
      .def_property(
          "alpha", [](const LandmarkFilterParams& self) { return self.points.alpha; },
          [](LandmarkFilterParams& self, double alpha) { self.points.alpha = alpha; })
      .def_property(
          "beta", [](const LandmarkFilterParams& self) { return self.points.beta; },
          [](LandmarkFilterParams& self, double beta) { self.points.beta = beta; })
      .def_readwrite("scale_sigma", &LandmarkFilterParams::scale_sigma)
      .def_readwrite("scale_drift", &LandmarkFilterParams::scale_drift)
      .def_readwrite("clock_sigma", &LandmarkFilterParams::clock_sigma)
      .def("validate", &LandmarkFilterParams::validate);
}

}  // namespace

void bindLandmarkFilter(py::module_& module) {
  bindParams(module);
  py::class_<LandmarkFilter>(
      module, "LandmarkFilter",
      "Simultaneous localization and mapping in the plane by an unscented Kalman filter. Poses "
      "are (3,) x, y, heading: metres, radians.")
      .def(py::init(&LandmarkFilter::make), "params"_a, "pose"_a, "covariance"_a,
           "covariance (3, 3) of the pose, map's axes, positive definite")
      .def(
          "predict",
          [](LandmarkFilter& self, const Pose2& step, const Eigen::Matrix3d& noise, double duration) {
            self.predict({step, noise, step.position.norm()}, duration);
          },
          "step"_a, "noise"_a, "duration"_a = 0.0,
          "step (3,) in the robot's frame where it begins, and there noise (3, 3) is felt; seconds")
      .def("update", &updateKnown, "landmarks"_a, "sightings"_a,
           "sightings of one moment, and the index of each one's landmark")
      .def("add", &LandmarkFilter::add, "sighting"_a, "index of a new landmark")
      .def_property_readonly("pose", &LandmarkFilter::pose)
      .def_property_readonly("landmarks", &LandmarkFilter::landmarks)
      .def_property_readonly(
          "covariance", [](const LandmarkFilter& self) { return self.covariance(); },
          "(n, n) of x, y, heading and all landmarks, map's axes")
      .def_property_readonly(
          "pose_covariance",
          [](const LandmarkFilter& self) { return self.covariance(std::vector<size_t>{}); }, "(3, 3)")
      .def_property_readonly("scale", &LandmarkFilter::scale,
                             "of odometry; what it measures is multiplied by it")
      .def_property_readonly("clock_offset", &LandmarkFilter::clockOffset,
                             "seconds to add to stamps of sightings")
      .def_property_readonly("scale_variance", &LandmarkFilter::scaleVariance,
                             "0: the scale is not estimated")
      .def_property_readonly("clock_variance", &LandmarkFilter::clockVariance,
                             "of clock_offset, squared seconds; 0: it is not estimated")
      .def_property_readonly("nis", &LandmarkFilter::nis, "normalized innovation squared of the last update")
      .def_property_readonly("nis_width", &LandmarkFilter::nisWidth, "its degrees of freedom")
      .def_property_readonly("repairs", &LandmarkFilter::repairs,
                             "of covariances that rounding made indefinite");
}

}  // namespace sextant
