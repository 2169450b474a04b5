// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

namespace sextant {

void bindPose(pybind11::module_& module);
void bindCamera(pybind11::module_& module);
void bindMarker(pybind11::module_& module);
void bindMarkerFamily(pybind11::module_& module);
void bindMarkerDetector(pybind11::module_& module);
void bindMarkerPose(pybind11::module_& module);
void bindMarkerMap(pybind11::module_& module);
void bindMarkerLocator(pybind11::module_& module);
void bindMarkerLocalization(pybind11::module_& module);
void bindMapMaker(pybind11::module_& module);
void bindArena(pybind11::module_& module);
void bindRoomRenderer(pybind11::module_& module);
void bindLocalFeatures(pybind11::module_& module);
void bindDescriptorIndex(pybind11::module_& module);
void bindPlaneSighting(pybind11::module_& module);
void bindOdometrySteps(pybind11::module_& module);
void bindLandmarkFilter(pybind11::module_& module);
void bindLandmarkSlam(pybind11::module_& module);
void bindLandmarkTimeline(pybind11::module_& module);
void bindLandmarkMapFile(pybind11::module_& module);
void bindLandmarkSmoother(pybind11::module_& module);
void bindMarkerLandmarks(pybind11::module_& module);

}  // namespace sextant
