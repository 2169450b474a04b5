// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "image_arrays.hpp"
#include "params.hpp"
#include "sextant/places/descriptor_index.hpp"
#include "sextant/places/local_features.hpp"
#include "sextant/places/photo_scores.hpp"

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

// Exact types, as the arrays may be memory-mapped and large.
using Positions = py::array_t<uint16_t, py::array::c_style>;
using Codes = py::array_t<int8_t, py::array::c_style>;

/// Views of rows first to first + count of all keypoints. @throws py::value_error if the shapes do not fit
CodedKeypoints codedKeypoints(const Positions& positions, const Codes& codes, int64_t first, int64_t count) {
  if (positions.ndim() != 2 || positions.shape(1) != 2 || codes.ndim() != 2 ||
      positions.shape(0) != codes.shape(0))
    throw py::value_error("positions must be (n, 2) and codes (n, width)");
  if (first < 0 || count < 0 || first + count > codes.shape(0))
    throw py::value_error("a photo has keypoints " + std::to_string(first) + " to " +
                          std::to_string(first + count) + " of " + std::to_string(codes.shape(0)));
  const int64_t width = codes.shape(1);
  return {Eigen::Map<const CodedKeypoints::Positions>(positions.data() + 2 * first, count, 2),
          Eigen::Map<const CodedKeypoints::Codes>(codes.data() + width * first, count, width)};
}

py::tuple photoScores(const Positions& positions, const Codes& codes, const Positions& map_positions,
                      const Codes& map_codes, const std::vector<int64_t>& firsts,
                      const std::vector<int64_t>& counts, int k) {
  if (firsts.size() != counts.size() || k < 1)
    throw py::value_error("firsts and counts must be as many, and k at least 1");
  const CodedKeypoints image = codedKeypoints(positions, codes, 0, codes.shape(0));
  std::vector<CodedKeypoints> photos;
  for (size_t i = 0; i < firsts.size(); ++i)
    photos.push_back(codedKeypoints(map_positions, map_codes, firsts[i], counts[i]));
  PhotoScores scores;
  {
    const py::gil_scoped_release release;
    scores = scorePhotos(image, photos, k);
  }
  return py::make_tuple(scores.distinctive, scores.consistent, scores.background, scores.nearest);
}

py::tuple photoMatches(const Positions& positions, const Codes& codes, const Positions& photo_positions,
                       const Codes& photo_codes) {
  const PhotoMatches found =
      matchPhoto(codedKeypoints(positions, codes, 0, codes.shape(0)),
                 codedKeypoints(photo_positions, photo_codes, 0, photo_codes.shape(0)));
  return py::make_tuple(found.distances, found.rows, found.mutual);
}

void bindPhotoScores(py::module_& module) {
  module.def(
      "photo_scores", &photoScores, "positions"_a, "codes"_a, "map_positions"_a, "map_codes"_a, "firsts"_a,
      "counts"_a, "k"_a,
      "Compares an image with m photos. positions: uint16 (n, 2), x and y in units of the longer side / "
      "65535; codes: int8 (n, width); map_positions, map_codes: of all photos; firsts, counts: rows of "
      "each photo. Returns (distinctive (m,), consistent (m,), background (n,), nearest (n,)): two "
      "scores of each photo, distance of each keypoint from those that do not match it (the k-th of two "
      "of each photo), and from the most similar one.");
  module.def(
      "photo_matches", &photoMatches, "positions"_a, "codes"_a, "photo_positions"_a, "photo_codes"_a,
      "Returns (distances, rows, is_mutual), each (n,), of the most similar keypoint of a photo for each "
      "of an image; inf, -1, False if the photo has none.");
}

}  // namespace
}  // namespace sextant

PYBIND11_MODULE(places, module) {
  module.doc() = "Local image features and their nearest-neighbour index.";
  sextant::bindLocalFeatures(module);
  sextant::bindDescriptorIndex(module);
  sextant::bindPhotoScores(module);
}
