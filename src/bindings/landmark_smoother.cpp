// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_smoother.hpp"

#include "bindings.hpp"
#include "casters.hpp"
#include "plane_casters.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {

namespace {

/// Rows (moment, landmark) beside sightings, which are easier to make in Python than moments.
std::vector<DriveMoment> driveOf(const std::vector<Pose2>& steps, const std::vector<Eigen::Matrix3d>& noises,
                                 const std::vector<std::pair<size_t, size_t>>& of,
                                 const std::vector<PlaneSighting>& sightings) {
  if (steps.size() != noises.size() || of.size() != sightings.size())
    throw std::invalid_argument("every step needs a noise, and every sighting its moment and landmark");
  std::vector<DriveMoment> drive(steps.size() + 1);
  for (size_t i = 0; i < steps.size(); ++i)
    drive[i + 1].step = {steps[i], noises[i], steps[i].position.norm()};
  for (size_t i = 0; i < of.size(); ++i) {
    if (of[i].first >= drive.size())
      throw std::invalid_argument("there is no moment " + std::to_string(of[i].first));
    drive[of[i].first].seen.push_back({of[i].second, sightings[i]});
  }
  return drive;
}

}  // namespace

void bindLandmarkSmoother(py::module_& module) {
  module.def(
      "smooth_drive",
      [](const std::vector<Pose2>& steps, const std::vector<Eigen::Matrix3d>& noises,
         const std::vector<std::pair<size_t, size_t>>& of, const std::vector<PlaneSighting>& sightings,
         const std::vector<Pose2>& poses, const std::vector<PlaneLandmark>& landmarks) {
        const auto found = smoothDrive(driveOf(steps, noises, of, sightings), {poses, landmarks});
        if (!found) throw std::runtime_error("the search for the most probable drive failed");
        return std::make_tuple(found->estimate.T_map_base, found->estimate.landmarks, found->cost);
      },
      "steps"_a, "noises"_a, "seen"_a, "sightings"_a, "poses"_a, "landmarks"_a,
      py::call_guard<py::gil_scoped_release>(),
      "The most probable drive and map by all steps (n) and sightings (m) at once; seen: moment and landmark "
      "of each.\n"
      "poses (n + 1) and landmarks: where the search begins. Returns both, and half the sum of the squared "
      "whitened "
      "residuals.");
}

}  // namespace sextant
