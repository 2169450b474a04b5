// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <cmath>
#include <utility>

#include "pose_casters.hpp"
#include "sextant/geometry/camera.hpp"
#include "sextant/geometry/pose.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {
namespace {

void bindPose(py::module_& module) {
  module.def(
      "pose_from_xyz_rpy", &poseFromXyzRpy, "xyz"_a, "rpy"_a,
      "Returns the 4 x 4 pose of a translation in metres and fixed-axis roll, pitch, yaw in radians: R = "
      "Rz(yaw) Ry(pitch) Rx(roll).");
  module.def(
      "pose_from_quaternion",
      [](const Eigen::Vector3d& position, const Eigen::Vector4d& xyzw, double tolerance) {
        return poseFromQuaternion(position, Eigen::Quaterniond(xyzw), tolerance);
      },
      "position"_a, "xyzw"_a, "tolerance"_a = 0.01,
      "Returns the 4 x 4 pose of a position in metres and a quaternion; ValueError if the norm of the "
      "quaternion differs from 1 by more than the tolerance.");
  module.def("rpy_from_rotation", &rpyFromRotation, "rotation"_a,
             "Returns roll, pitch, yaw (radians) of a 3 x 3 rotation.");
  module.def("exp_so3", &expSO3, "delta"_a,
             "Returns the rotation (3 x 3) about delta by the norm of delta, in radians.");
  module.def("log_so3", &logSO3, "rotation"_a, "Inverse of exp_so3; the norm of the result is in [0, pi].");
  module.def("perturbed", &perturbed, "pose"_a, "xi"_a,
             "Perturbs a pose by xi (6) in the axes of the parent frame: p + xi[:3], exp_so3(xi[3:]) R.");
  module.def("pose_error", &poseError, "truth"_a, "estimate"_a,
             "Returns the xi (6) for which truth = perturbed(estimate, xi); NEES is computed from it.");
  module.def(
      "mean_pose", &meanPose, "poses"_a,
      "Returns the mean translation with the eigenvector mean of the quaternions (Markley et al. 2007).");
}

using Pixels = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

Pixels projectPoints(const CameraModel& camera, const Eigen::Ref<const Points>& points) {
  Pixels pixels = Pixels::Constant(points.rows(), 2, NAN);
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    if (const auto pixel = camera.project(points.row(i))) pixels.row(i) = *pixel;
  return pixels;
}

Points rays(const CameraModel& camera, const Eigen::Ref<const Pixels>& pixels) {
  Points directions = Points::Constant(pixels.rows(), 3, NAN);
  for (Eigen::Index i = 0; i < pixels.rows(); ++i)
    if (const auto ray = camera.unproject(pixels.row(i)); ray && ray->z() > 0)
      directions.row(i) = *ray / ray->z();
  return directions;
}

void bindCalibration(py::module_& module) {
  py::class_<CameraCalibration>(
      module, "CameraCalibration",
      "Intrinsic calibration in the fields and conventions of sensor_msgs/CameraInfo.")
      .def(py::init<>())
      .def_readwrite("width", &CameraCalibration::width, "image width, pixels")
      .def_readwrite("height", &CameraCalibration::height, "image height, pixels")
      .def_readwrite("distortion_model", &CameraCalibration::distortion_model,
                     "plumb_bob, rational_polynomial or equidistant")
      .def_readwrite("D", &CameraCalibration::D, "(n,) distortion coefficients in OpenCV's order")
      .def_readwrite("K", &CameraCalibration::K, "(3, 3) camera matrix of the raw image, pixels")
      .def_readwrite("R", &CameraCalibration::R, "(3, 3) rectification rotation")
      .def_readwrite("P", &CameraCalibration::P, "(3, 4) projection matrix of the rectified image, pixels")
      .def(py::pickle(
          [](const CameraCalibration& each) {
            return py::make_tuple(each.width, each.height, each.distortion_model, each.D, each.K, each.R,
                                  each.P);
          },
          [](const py::tuple& state) {
            return CameraCalibration{state[0].cast<int>(),
                                     state[1].cast<int>(),
                                     state[2].cast<std::string>(),
                                     state[3].cast<std::vector<double>>(),
                                     state[4].cast<Eigen::Matrix3d>(),
                                     state[5].cast<Eigen::Matrix3d>(),
                                     state[6].cast<Eigen::Matrix<double, 3, 4>>()};
          }));
}

void bindCamera(py::module_& module) {
  py::class_<CameraModel>(module, "CameraModel",
                          "Projection of a calibrated camera, from the optical frame to pixels.")
      .def(py::init([](const CameraCalibration& calibration, bool rectified) {
             return CameraModel(calibration,
                                rectified ? CameraModel::Image::rectified : CameraModel::Image::raw);
           }),
           "calibration"_a, "rectified"_a = false)
      .def_property_readonly("width", &CameraModel::width, "image width, pixels")
      .def_property_readonly("height", &CameraModel::height, "image height, pixels")
      .def_property_readonly("focal_length", &CameraModel::focalLength,
                             "focal length, pixels; mean of both axes")
      .def("project", &CameraModel::project, "p_camera"_a,
           "Projects a point (3, metres) to a pixel (2); None if it has no projection.")
      .def_property_readonly(
          "size", [](const CameraModel& camera) { return std::make_pair(camera.width(), camera.height()); },
          "Width and height, pixels.")
      .def("project_points", &projectPoints, "points"_a,
           "Projects points (n, 3, metres) to pixels (n, 2); NaN for points without a projection.")
      .def("rays", &rays, "pixels"_a,
           "Returns rays (n, 3) with z = 1 toward pixels (n, 2); NaN where the lens model has no ray with z "
           "> 0.")
      .def("unproject", &CameraModel::unproject, "pixel"_a,
           "Returns the unit vector (3) toward a pixel (2), or None if the lens model has no ray.");
}

}  // namespace
}  // namespace sextant

PYBIND11_MODULE(geometry, module) {
  module.doc() = "Poses and cameras.";
  sextant::bindPose(module);
  sextant::bindCalibration(module);
  sextant::bindCamera(module);
}
