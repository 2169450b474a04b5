// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/places/local_features.hpp"

#include "bindings.hpp"
#include "casters.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {
namespace {

py::array_t<float> keypointArray(const std::vector<cv::KeyPoint>& keypoints) {
  py::array_t<float> array({keypoints.size(), size_t{5}});
  for (size_t i = 0; i < keypoints.size(); ++i) {
    const cv::KeyPoint& point = keypoints[i];
    const float values[] = {point.pt.x, point.pt.y, point.size, point.angle, point.response};
    std::copy(std::begin(values), std::end(values), array.mutable_data(i, 0));
  }
  return array;
}

}  // namespace

void bindLocalFeatures(py::module_& module) {
  py::class_<FeatureParams>(module, "FeatureParams")
      .def(py::init<>())
      .def_static("plain", &FeatureParams::plain, "detector"_a, "extractor"_a)
      .def_readwrite("detector", &FeatureParams::detector)
      .def_readwrite("extractor", &FeatureParams::extractor)
      .def_readwrite("max_side", &FeatureParams::max_side)
      .def_readwrite("max_features", &FeatureParams::max_features)
      .def_readwrite("upright", &FeatureParams::upright)
      .def_readwrite("root", &FeatureParams::root)
      .def_readwrite("support", &FeatureParams::support)
      .def_readwrite("sift_contrast", &FeatureParams::sift_contrast)
      .def_readwrite("surf_threshold", &FeatureParams::surf_threshold)
      .def_readwrite("akaze_threshold", &FeatureParams::akaze_threshold)
      .def_readwrite("orb_wta_k", &FeatureParams::orb_wta_k)
      .def("validate", &FeatureParams::validate);
  py::class_<LocalFeatures>(module, "LocalFeatures", "Keypoints and descriptors of one picture.")
      .def_property_readonly(
          "size", [](const LocalFeatures& self) { return py::make_tuple(self.size.width, self.size.height); },
          "(width, height) of the picture in pixels.")
      .def_property_readonly(
          "keypoints", [](const LocalFeatures& self) { return keypointArray(self.keypoints); },
          "float32 (n, 5): x, y, size in pixels, angle in degrees, response.")
      .def_property_readonly(
          "descriptors", [](const LocalFeatures& self) { return arrayFromMatrix(self.descriptors); },
          "float32 (n, width), or uint8 for bits.");
  py::class_<FeatureExtractor>(module, "FeatureExtractor", "Finds and describes the keypoints of a picture.")
      .def(py::init<const FeatureParams&>(), "params"_a)
      .def(
          "extract",
          [](const FeatureExtractor& extractor, const ImageArray& array) {
            const cv::Mat image = imageFromArray(array);
            py::gil_scoped_release release;
            return extractor.extract(image);
          },
          "image"_a, "LocalFeatures; image: uint8, (height, width) grey or (height, width, 3) BGR.");
  module.def("feature_names", &featureNames, "The detectors and extractors there are.");
  module.def("is_binary_extractor", &isBinaryExtractor, "extractor"_a);
}

}  // namespace sextant
