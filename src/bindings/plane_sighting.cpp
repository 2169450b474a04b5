// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/plane_sighting.hpp"

#include <pybind11/operators.h>

#include "bindings.hpp"
#include "casters.hpp"
#include "plane_casters.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {

namespace {

void bindPlane(py::module_& module) {
  py::class_<PlaneLandmark>(module, "PlaneLandmark", "Something that stands in the plane, in the map frame.")
      .def(py::init([](const Eigen::Vector2d& position, const std::optional<double>& heading) {
             return PlaneLandmark{position, heading};
           }),
           "position"_a, "heading"_a = py::none())
      .def_readonly("position", &PlaneLandmark::position, "(2,) metres")
      .def_readonly("heading", &PlaneLandmark::heading, "radians, or None");
  py::class_<PlaneSighting>(module, "PlaneSighting", "What a sensor says of a landmark, in the robot frame.")
      .def(py::init([](const Eigen::Vector2d& position, const Eigen::MatrixXd& covariance,
                       const std::optional<double>& heading) {
             const Eigen::Index width = heading ? 3 : 2;
             if (covariance.rows() != width || covariance.cols() != width)
               throw std::invalid_argument("covariance must be " + std::to_string(width) + " x " +
                                           std::to_string(width));
             PlaneSighting sighting{position, heading, Eigen::Matrix3d::Zero()};
             sighting.covariance.topLeftCorner(width, width) = covariance;
             return sighting;
           }),
           "position"_a, "covariance"_a, "heading"_a = py::none(),
           "position (2,) metres; covariance (2, 2), or (3, 3) with a heading in radians")
      .def_readonly("position", &PlaneSighting::position, "(2,) metres")
      .def_readonly("heading", &PlaneSighting::heading, "radians, or None")
      .def_readonly("covariance", &PlaneSighting::covariance, "(3, 3) of x, y, heading");
}

void bindLabels(py::module_& module) {
  py::class_<LandmarkLabel>(module, "LandmarkLabel",
                            "What kind of thing, and which of them where a sighting tells.")
      .def(py::init<std::string, std::optional<int>>(), "class_name"_a, "id"_a = py::none())
      .def_readonly("class_name", &LandmarkLabel::class_name)
      .def_readonly("id", &LandmarkLabel::id, "of a printed marker, or None")
      .def(py::self == py::self)
      .def("__hash__",
           [](const LandmarkLabel& self) { return py::hash(py::make_tuple(self.class_name, self.id)); })
      .def("__repr__", [](const LandmarkLabel& self) {
        return "LandmarkLabel('" + self.class_name + "'" + (self.id ? ", " + std::to_string(*self.id) : "") +
               ")";
      });
  py::class_<LabelledSighting>(module, "LabelledSighting", "A sighting and what it is of.")
      .def(py::init<LandmarkLabel, PlaneSighting, bool>(), "label"_a, "sighting"_a, "begins"_a = true,
           "begins: whether it may be the first of a landmark")
      .def_readonly("label", &LabelledSighting::label)
      .def_readonly("sighting", &LabelledSighting::sighting)
      .def_readonly("begins", &LabelledSighting::begins);
}

}  // namespace

void bindPlaneSighting(py::module_& module) {
  bindPlane(module);
  bindLabels(module);
}

}  // namespace sextant
