// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "params.hpp"
#include "sextant/images/camera_driver_node_params.hpp"

PYBIND11_MODULE(images, module) {
  module.doc() = "Cameras and files as sources of images.";
  sextant::bindParams<sextant::CameraDriverNodeParams>(module, "CameraDriverNodeParams",
                                                       "Parameters of the nodelet sextant/CameraDriver.");
}
