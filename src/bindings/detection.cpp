// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include "image_arrays.hpp"
#include "marker_casters.hpp"
#include "params.hpp"
#include "sextant/detection/corner_refiner.hpp"
#include "sextant/detection/marker_detector_node_params.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {
namespace {

void bindMarkerDetector(py::module_& module) {
  bindParams<DetectorParams>(module, "DetectorParams", "Parameters of MarkerDetector.");
  bindParams<MarkerDetectorNodeParams>(module, "MarkerDetectorNodeParams",
                                       "Parameters of the nodelet sextant/MarkerDetector.")
      .def_readwrite("detector", &MarkerDetectorNodeParams::detector, "DetectorParams");
  py::class_<MarkerDetector>(module, "MarkerDetector", "Detects printed markers in images.")
      .def(py::init(&makeMarkerDetector), "params"_a)
      .def(
          "detect",
          [](MarkerDetector& detector, const ImageArray& array, const CameraModel* camera) {
            const cv::Mat image = imageFromArray(array);
            py::gil_scoped_release release;
            return detector.detect(image, camera);
          },
          "image"_a, "camera"_a = nullptr,
          "Returns a list of Detection. image: uint8, (height, width) grey or (height, width, 3) BGR; "
          "camera: "
          "CameraModel of the image, to refine corners with lens distortion, or None.");
  module.def(
      "refine_corners",
      [](const ImageArray& image, const Corners& corners, int modules, bool white_inside, double start_sigma,
         const CameraModel* camera) {
        const BorderSquare square{modules, white_inside, start_sigma};
        const RefinedCorners refined = refineCorners(imageFromArray(image), corners, square, camera);
        return py::make_tuple(refined.corners, refined.sigmas);
      },
      "image"_a, "corners"_a, "modules"_a, "white_inside"_a = false,
      "start_sigma"_a = BorderSquare().start_sigma, "camera"_a = nullptr,
      "Refines corners (4, 2) to subpixel accuracy. Returns (corners, sigmas): (4, 2) pixels and four "
      "standard "
      "deviations of their coordinates, pixels.");
}

}  // namespace
}  // namespace sextant

PYBIND11_MODULE(detection, module) {
  module.doc() = "Detects printed markers in images.";
  py::module_::import("sextant._core.geometry");
  py::module_::import("sextant._core.markers");
  sextant::bindMarkerDetector(module);
}
