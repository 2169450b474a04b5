// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include "image_arrays.hpp"
#include "params.hpp"
#include "sextant/places/descriptor_index.hpp"
#include "sextant/places/local_features.hpp"

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

void bindLocalFeatures(py::module_& module) {
  bindParams<FeatureParams>(module, "FeatureParams")
      .def_static("plain", &FeatureParams::plain, "detector"_a, "extractor"_a);
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

template <class T>
py::array_t<T> table(const std::vector<T>& values, int columns) {
  return py::array_t<T>({static_cast<py::ssize_t>(values.size()) / columns, py::ssize_t{columns}},
                        values.data());
}

py::tuple search(const DescriptorIndex& index, const py::array& descriptors, int k) {
  const cv::Mat matrix = matrixFromArray(descriptors);
  Neighbours found;
  {
    py::gil_scoped_release release;
    found = index.search(matrix, k);
  }
  return py::make_tuple(table(found.distances, k), table(found.owners, k), table(found.rows, k));
}

void bindDescriptorIndex(py::module_& module) {
  py::class_<DescriptorIndex>(module, "DescriptorIndex",
                              "Descriptors of many pictures, searched by nearness.")
      .def(py::init([](const std::string& matcher, const py::array& samples, int64_t expected) {
             const cv::Mat matrix = matrixFromArray(samples);
             const py::gil_scoped_release others;
             return makeDescriptorIndex(matcher, matrix, expected);
           }),
           "matcher"_a, "samples"_a, "expected"_a)
      .def_static("read", &readDescriptorIndex, "path"_a, "offset"_a,
                  py::call_guard<py::gil_scoped_release>())
      .def(
          "add",
          [](DescriptorIndex& index, int32_t owner, const py::array& descriptors) {
            const cv::Mat matrix = matrixFromArray(descriptors);
            const py::gil_scoped_release others;
            index.add(owner, matrix);
          },
          "owner"_a, "descriptors"_a)
      .def("remove", &DescriptorIndex::remove, "owner"_a, py::call_guard<py::gil_scoped_release>())
      .def("search", &search, "descriptors"_a, "k"_a,
           "(distances, owners, rows), each (n, k), nearest first; owner -1, infinitely far: no more.")
      .def_property_readonly("bytes", &DescriptorIndex::bytes)
      .def("append", &DescriptorIndex::append, "path"_a, py::call_guard<py::gil_scoped_release>())
      .def("__len__", &DescriptorIndex::size);
  module.def("matcher_names", &matcherNames);
  module.def("validate_matcher", &validateMatcher, "matcher"_a, "extractor"_a, "orb_wta_k"_a);
}

}  // namespace
}  // namespace sextant

PYBIND11_MODULE(places, module) {
  module.doc() = "Image features and their index.";
  sextant::bindLocalFeatures(module);
  sextant::bindDescriptorIndex(module);
}
