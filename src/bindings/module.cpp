// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bindings.hpp"

PYBIND11_MODULE(_core, module) {
  module.doc() = "Sextant's C++ core: what its nodes compute, without ROS.";
  sextant::bindPose(module);
  sextant::bindCamera(module);
  sextant::bindMarker(module);
  sextant::bindMarkerFamily(module);
  sextant::bindMarkerDetector(module);
  sextant::bindMarkerPose(module);
  sextant::bindMarkerMap(module);
  sextant::bindMarkerLocator(module);
  sextant::bindMarkerLocalization(module);
  sextant::bindMapMaker(module);
  sextant::bindArena(module);
  sextant::bindRoomRenderer(module);
  sextant::bindLocalFeatures(module);
  sextant::bindDescriptorIndex(module);
  sextant::bindPlaneSighting(module);
  sextant::bindOdometrySteps(module);
  sextant::bindLandmarkFilter(module);
  sextant::bindLandmarkSlam(module);
  sextant::bindLandmarkTimeline(module);
  sextant::bindLandmarkMapFile(module);
  sextant::bindLandmarkSmoother(module);
  sextant::bindMarkerLandmarks(module);
}
