// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/marker_family.hpp"

#include <algorithm>
#include <map>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "sextant/markers/apriltag_family.hpp"
#include "sextant/markers/aruco_dictionary.hpp"

namespace sextant {
namespace {

// Families that both libraries have; OpenCV's markers are rotated by 180 degrees.
const std::map<std::string, std::string>& sharedPrints() {
  static const std::map<std::string, std::string> names = {{"DICT_APRILTAG_16h5", "tag16h5"},
                                                           {"DICT_APRILTAG_25h9", "tag25h9"},
                                                           {"DICT_APRILTAG_36h10", "tag36h10"},
                                                           {"DICT_APRILTAG_36h11", "tag36h11"}};
  return names;
}

// Not by apriltag_to_image: that of libapriltag 0.10 draws the white ring in the wrong place.
MarkerImage aprilTagImage(const std::string& family, int id) {
  const AprilTagFamily tags = makeAprilTagFamily(family);
  MarkerImage marker;
  marker.border_begin = (tags->total_width - tags->width_at_border) / 2;
  marker.border_end = marker.border_begin + tags->width_at_border;
  marker.modules = cv::Mat(tags->total_width, tags->total_width, CV_8UC1, cv::Scalar(0));
  const int ring = marker.border_begin - (tags->reversed_border ? 0 : 1);
  const int width = tags->total_width - 2 * ring;
  cv::rectangle(marker.modules, cv::Rect(ring, ring, width, width), cv::Scalar(255));
  for (uint32_t bit = 0; bit < tags->nbits; ++bit)
    if (tags->codes[id] >> (tags->nbits - bit - 1) & 1)
      marker.modules.at<uchar>(marker.border_begin + static_cast<int>(tags->bit_y[bit]),
                               marker.border_begin + static_cast<int>(tags->bit_x[bit])) = 255;
  return marker;
}

MarkerImage arucoImage(const std::string& family, int id) {
  const auto dictionary = makeArucoDictionary(family);
  MarkerImage marker;
  marker.border_end = dictionary.markerSize + 2;
  marker.modules = arucoModules(dictionary, id);
  return marker;
}

}  // namespace

bool isAprilTag(const std::string& canonical) { return canonical.rfind("tag", 0) == 0; }

std::vector<std::string> markerFamilies() {
  std::vector<std::string> names = arucoDictionaries();
  const auto tags = aprilTagFamilies();
  names.insert(names.end(), tags.begin(), tags.end());
  return names;
}

std::string canonicalFamily(const std::string& name) {
  const auto names = markerFamilies();
  const auto known = [&names](const std::string& family) {
    return std::find(names.begin(), names.end(), family) != names.end();
  };
  if (!known(name)) {
    std::string all;
    for (const auto& family : names) all += " " + family;
    throw std::invalid_argument("unknown marker family '" + name + "'; known are" + all);
  }
  const auto shared = sharedPrints().find(name);
  return shared == sharedPrints().end() || !known(shared->second) ? name : shared->second;
}

int familySize(const std::string& name) {
  const std::string family = canonicalFamily(name);
  if (isAprilTag(family)) return static_cast<int>(makeAprilTagFamily(family)->ncodes);
  return makeArucoDictionary(family).bytesList.rows;
}

MarkerImage markerImage(const std::string& name, int id) {
  const std::string family = canonicalFamily(name);
  const int size = familySize(family);
  if (id < 0 || id >= size)
    throw std::invalid_argument("marker " + std::to_string(id) + " is not in " + family +
                                ", whose ids are 0 to " + std::to_string(size - 1));
  return isAprilTag(family) ? aprilTagImage(family, id) : arucoImage(family, id);
}

}  // namespace sextant
