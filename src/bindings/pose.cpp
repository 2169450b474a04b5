// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/geometry/pose.hpp"

#include "bindings.hpp"
#include "casters.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {

void bindPose(py::module_& module) {
  module.def(
      "pose_from_xyz_rpy", &poseFromXyzRpy, "xyz"_a, "rpy"_a,
      "4 x 4 pose from metres and fixed-axis roll, pitch, yaw in radians: R = Rz(yaw) Ry(pitch) Rx(roll).");
  module.def("rpy_from_rotation", &rpyFromRotation, "rotation"_a,
             "Roll, pitch, yaw (radians) of a 3 x 3 rotation.");
  module.def("exp_so3", &expSO3, "delta"_a, "Rotation by |delta| radians about delta.");
  module.def("log_so3", &logSO3, "rotation"_a, "Inverse of exp_so3, angle in [0, pi].");
  module.def("perturbed", &perturbed, "pose"_a, "xi"_a,
             "p + xi[:3], Exp(xi[3:]) R: moved in the parent's axes.");
  module.def("pose_error", &poseError, "truth"_a, "estimate"_a,
             "xi (6) with truth = perturbed(estimate, xi): what NEES is computed from.");
  module.def("mean_pose", &meanPose, "poses"_a,
             "Mean translation, eigenvector mean of the quaternions (Markley 2007).");
}

}  // namespace sextant
