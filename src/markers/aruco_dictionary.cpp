// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/aruco_dictionary.hpp"

#include <map>

namespace sextant {
namespace {

const std::map<std::string, int>& dictionaries() {
  using namespace cv::aruco;
  static const std::map<std::string, int> names = {{"DICT_4X4_50", DICT_4X4_50},
                                                   {"DICT_4X4_100", DICT_4X4_100},
                                                   {"DICT_4X4_250", DICT_4X4_250},
                                                   {"DICT_4X4_1000", DICT_4X4_1000},
                                                   {"DICT_5X5_50", DICT_5X5_50},
                                                   {"DICT_5X5_100", DICT_5X5_100},
                                                   {"DICT_5X5_250", DICT_5X5_250},
                                                   {"DICT_5X5_1000", DICT_5X5_1000},
                                                   {"DICT_6X6_50", DICT_6X6_50},
                                                   {"DICT_6X6_100", DICT_6X6_100},
                                                   {"DICT_6X6_250", DICT_6X6_250},
                                                   {"DICT_6X6_1000", DICT_6X6_1000},
                                                   {"DICT_7X7_50", DICT_7X7_50},
                                                   {"DICT_7X7_100", DICT_7X7_100},
                                                   {"DICT_7X7_250", DICT_7X7_250},
                                                   {"DICT_7X7_1000", DICT_7X7_1000},
                                                   {"DICT_ARUCO_ORIGINAL", DICT_ARUCO_ORIGINAL},
                                                   {"DICT_APRILTAG_16h5", DICT_APRILTAG_16h5},
                                                   {"DICT_APRILTAG_25h9", DICT_APRILTAG_25h9},
                                                   {"DICT_APRILTAG_36h10", DICT_APRILTAG_36h10},
                                                   {"DICT_APRILTAG_36h11", DICT_APRILTAG_36h11}};
  return names;
}

}  // namespace

std::vector<std::string> arucoDictionaries() {
  std::vector<std::string> names;
  for (const auto& entry : dictionaries()) names.push_back(entry.first);
  return names;
}

#ifdef SEXTANT_ARUCO_IN_OBJDETECT

cv::aruco::Dictionary makeArucoDictionary(const std::string& name) {
  return cv::aruco::getPredefinedDictionary(dictionaries().at(name));
}

cv::Mat arucoModules(const cv::aruco::Dictionary& dictionary, int id) {
  cv::Mat modules;
  dictionary.generateImageMarker(id, dictionary.markerSize + 2, modules, 1);
  return modules;
}

void detectArucoMarkers(const cv::Mat& image, const cv::aruco::Dictionary& dictionary,
                        const cv::aruco::DetectorParameters& parameters,
                        std::vector<std::vector<cv::Point2f>>& corners, std::vector<int>& ids) {
  cv::aruco::ArucoDetector(dictionary, parameters).detectMarkers(image, corners, ids);
}

#else

cv::aruco::Dictionary makeArucoDictionary(const std::string& name) {
  return *cv::aruco::getPredefinedDictionary(dictionaries().at(name));
}

cv::Mat arucoModules(const cv::aruco::Dictionary& dictionary, int id) {
  cv::Mat modules;
  dictionary.drawMarker(id, dictionary.markerSize + 2, modules, 1);
  return modules;
}

void detectArucoMarkers(const cv::Mat& image, const cv::aruco::Dictionary& dictionary,
                        const cv::aruco::DetectorParameters& parameters,
                        std::vector<std::vector<cv::Point2f>>& corners, std::vector<int>& ids) {
  cv::aruco::detectMarkers(image, cv::makePtr<cv::aruco::Dictionary>(dictionary), corners, ids,
                           cv::makePtr<cv::aruco::DetectorParameters>(parameters));
}

#endif

}  // namespace sextant
