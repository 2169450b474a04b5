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
  bindParams<FeatureParams>(module, "FeatureParams", "Parameters of FeatureExtractor.")
      .def_static("plain", &FeatureParams::plain, "detector"_a, "extractor"_a,
                  "Full-size images, detector and extractor with OpenCV's defaults.");
  py::class_<LocalFeatures>(module, "LocalFeatures", "Keypoints and descriptors of one image.")
      .def_property_readonly(
          "size", [](const LocalFeatures& self) { return py::make_tuple(self.size.width, self.size.height); },
          "(width, height) of the image in pixels.")
      .def_property_readonly(
          "keypoints", [](const LocalFeatures& self) { return keypointArray(self.keypoints); },
          "float32 (n, 5): x, y and size in pixels, angle in degrees, response.")
      .def_property_readonly(
          "descriptors", [](const LocalFeatures& self) { return arrayFromMatrix(self.descriptors); },
          "float32 (n, width), or uint8 (n, width) if binary.");
  py::class_<FeatureExtractor>(module, "FeatureExtractor",
                               "Detects and describes the keypoints of images; thread-safe.")
      .def(py::init<const FeatureParams&>(), "params"_a, "Raises ValueError for invalid parameters.")
      .def(
          "extract",
          [](const FeatureExtractor& extractor, const ImageArray& array) {
            const cv::Mat image = imageFromArray(array);
            py::gil_scoped_release release;
            return extractor.extract(image);
          },
          "image"_a,
          "Returns LocalFeatures of an image: uint8, (height, width) grey or (height, width, 3) BGR.");
  module.def("feature_names", &featureNames, "Names of the detectors and extractors.");
  module.def("is_binary_extractor", &isBinaryExtractor, "extractor"_a,
             "Whether the extractor's descriptors are binary; raises ValueError if it is unknown.");
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
  return py::make_tuple(table(found.distances, k), table(found.image_ids, k), table(found.rows, k));
}

void bindDescriptorIndex(py::module_& module) {
  py::class_<DescriptorIndex>(
      module, "DescriptorIndex",
      "Nearest-neighbour index of the descriptors of many images; searching is thread-safe.")
      .def(py::init([](const std::string& matcher, const py::array& samples, int64_t expected) {
             const cv::Mat matrix = matrixFromArray(samples);
             const py::gil_scoped_release release;
             return makeDescriptorIndex(matcher, matrix, expected);
           }),
           "matcher"_a, "samples"_a, "expected"_a,
           "Creates an empty index. samples: training descriptors (n, width); expected: number of "
           "descriptors.")
      .def_static("read", &readDescriptorIndex, "path"_a, "offset"_a,
                  py::call_guard<py::gil_scoped_release>(),
                  "Memory-maps an index that append() wrote at an offset in bytes; raises RuntimeError.")
      .def(
          "add",
          [](DescriptorIndex& index, int32_t image_id, const py::array& descriptors) {
            const cv::Mat matrix = matrixFromArray(descriptors);
            const py::gil_scoped_release release;
            index.add(image_id, matrix);
          },
          "image_id"_a, "descriptors"_a,
          "Adds the descriptors (n, width) of an image that is not in the index.")
      .def("remove", &DescriptorIndex::remove, "image_id"_a, py::call_guard<py::gil_scoped_release>(),
           "Removes the descriptors of an image, if there are any.")
      .def(
          "search", &search, "descriptors"_a, "k"_a,
          "Returns (distances, image_ids, rows), each (n, k), nearest first; inf, -1, -1 if there are fewer.")
      .def_property_readonly("bytes", &DescriptorIndex::bytes, "Memory of the stored descriptors.")
      .def("append", &DescriptorIndex::append, "path"_a, py::call_guard<py::gil_scoped_release>(),
           "Appends the index to a file; raises RuntimeError if writing fails.")
      .def("__len__", &DescriptorIndex::size);
  module.def("has_faiss", &hasFaiss,
             "Whether Sextant was built with faiss; without it, matcher faiss searches exactly.");
  module.def("matcher_names", &matcherNames, "Names of the matchers: faiss and OpenCV's.");
  module.def("validate_matcher", &validateMatcher, "matcher"_a, "extractor"_a, "orb_wta_k"_a,
             "Raises ValueError if the matcher cannot compare the extractor's descriptors.");
}

}  // namespace
}  // namespace sextant

PYBIND11_MODULE(places, module) {
  module.doc() = "Local image features and their nearest-neighbour index.";
  sextant::bindLocalFeatures(module);
  sextant::bindDescriptorIndex(module);
}
