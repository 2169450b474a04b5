// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/core/marker_detector.hpp"

#include "bindings.hpp"
#include "casters.hpp"
#include "sextant/core/corner_refiner.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {

void bindMarkerDetector(py::module_& module) {
  py::class_<DetectorParams>(module, "DetectorParams")
      .def(py::init<>())
      .def_readwrite("families", &DetectorParams::families)
      .def_readwrite("search", &DetectorParams::search)
      .def_readwrite("threads", &DetectorParams::threads)
      .def_readwrite("decimate", &DetectorParams::decimate)
      .def_readwrite("max_hamming", &DetectorParams::max_hamming)
      .def_readwrite("min_decision_margin", &DetectorParams::min_decision_margin)
      .def_readwrite("error_correction", &DetectorParams::error_correction)
      .def_readwrite("min_perimeter", &DetectorParams::min_perimeter)
      .def_readwrite("refine_corners", &DetectorParams::refine_corners)
      .def("validate", &DetectorParams::validate);
  py::class_<MarkerDetector>(module, "MarkerDetector", "Finds markers in an image.")
      .def(py::init(&makeMarkerDetector), "params"_a)
      .def(
          "detect",
          [](MarkerDetector& detector, const ImageArray& array) {
            const cv::Mat image = imageFromArray(array);
            py::gil_scoped_release release;
            return detector.detect(image);
          },
          "image"_a, "List of Detection; image: uint8, (height, width) grey or (height, width, 3) BGR.");
  module.def(
      "refine_corners",
      [](const ImageArray& image, const Corners& corners, int modules, bool white_inside) {
        return refineCorners(imageFromArray(image), corners, {modules, white_inside});
      },
      "image"_a, "corners"_a, "modules"_a, "white_inside"_a = false, "Corners (4 x 2) at subpixel, or None.");
}

}  // namespace sextant
