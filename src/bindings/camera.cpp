// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/geometry/camera.hpp"

#include "bindings.hpp"
#include "casters.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {

void bindCamera(py::module_& module) {
  py::class_<CameraCalibration>(module, "CameraCalibration",
                                "The fields and conventions of sensor_msgs/CameraInfo.")
      .def(py::init<>())
      .def_readwrite("width", &CameraCalibration::width)
      .def_readwrite("height", &CameraCalibration::height)
      .def_readwrite("distortion_model", &CameraCalibration::distortion_model)
      .def_readwrite("D", &CameraCalibration::D)
      .def_readwrite("K", &CameraCalibration::K)
      .def_readwrite("R", &CameraCalibration::R)
      .def_readwrite("P", &CameraCalibration::P);
  py::class_<CameraModel>(module, "CameraModel",
                          "Projection of a calibrated camera, optical frame to pixels.")
      .def(py::init([](const CameraCalibration& calibration, bool rectified) {
             return CameraModel(calibration,
                                rectified ? CameraModel::Image::rectified : CameraModel::Image::raw);
           }),
           "calibration"_a, "rectified"_a = false)
      .def_property_readonly("width", &CameraModel::width)
      .def_property_readonly("height", &CameraModel::height)
      .def_property_readonly("focal_length", &CameraModel::focalLength)
      .def("project", &CameraModel::project, "p_camera"_a, "Pixel (2) of a point (3, metres), or None.")
      .def("unproject", &CameraModel::unproject, "pixel"_a, "Unit vector (3) toward a pixel (2), or None.");
}

}  // namespace sextant
