// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/odometry_steps.hpp"

#include "bindings.hpp"
#include "casters.hpp"
#include "plane_casters.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {

void bindOdometrySteps(py::module_& module) {
  py::class_<OdometryNoiseParams>(
      module, "OdometryNoiseParams",
      "What a step of wheel odometry may be off by: deviations after a metre or a radian, "
      "that grow with the root.")
      .def(py::init<>())
      .def_readwrite("turn_by_turn", &OdometryNoiseParams::turn_by_turn, "radians")
      .def_readwrite("turn_by_way", &OdometryNoiseParams::turn_by_way, "radians")
      .def_readwrite("way_by_way", &OdometryNoiseParams::way_by_way, "metres")
      .def_readwrite("way_by_turn", &OdometryNoiseParams::way_by_turn, "metres")
      .def_readwrite("aside_by_way", &OdometryNoiseParams::aside_by_way, "metres")
      .def("validate", &OdometryNoiseParams::validate);
  module.def(
      "odometry_step_noise",
      [](const Pose2& step, const OdometryNoiseParams& params) { return noisyStep(step, params).noise; },
      "step"_a, "params"_a, "(3, 3) covariance of a small step (3,), felt where it begins");
}

}  // namespace sextant
