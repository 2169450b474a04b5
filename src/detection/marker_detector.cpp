// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/detection/marker_detector.hpp"

#include <set>
#include <stdexcept>

#include "apriltag_search.hpp"
#include "aruco_search.hpp"
#include "marker_tracker.hpp"
#include "sextant/base/range.hpp"
#include "sextant/markers/marker_family.hpp"

namespace sextant {
namespace {

// Not a family's canonical name but the asked one tells the backend: DICT_APRILTAG_36h11 is read by OpenCV.
bool isArucoName(const std::string& name) { return name.rfind("DICT_", 0) == 0; }

class TrackingDetector : public MarkerDetector {
 public:
  explicit TrackingDetector(std::vector<MarkerTracker> trackers) : trackers_(std::move(trackers)) {}

  std::vector<Detection> detect(const cv::Mat& image, const CameraModel* camera) override {
    if (image.type() != CV_8UC1 || image.empty())
      throw std::invalid_argument("MarkerDetector: the image must be 8-bit grey and not empty");
    std::vector<Detection> all;
    for (MarkerTracker& tracker : trackers_)
      for (Detection& found : tracker.find(image, camera)) all.push_back(std::move(found));
    return all;
  }

 private:
  std::vector<MarkerTracker> trackers_;
};

}  // namespace

void DetectorParams::validate() const {
  if (families.empty()) throw std::invalid_argument("families is empty, name at least one marker family");
  std::set<std::string> prints;
  try {
    for (const auto& family : families)
      if (!prints.insert(canonicalFamily(family)).second)
        throw std::invalid_argument("'" + family + "' is there twice: each marker would be found twice");
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(std::string("families: ") + error.what());
  }
  if (search != "full" && search != "tracking")
    throw std::invalid_argument("search is '" + search + "', it must be full or tracking");
  Range::closed(1, 64).require("threads", threads);
  Range::closed(1, 8).require("decimate", decimate);
  Range::closed(0, 3).require("max_hamming", max_hamming);
  Range::closed(0, 255).require("min_decision_margin", min_decision_margin);
  Range::closed(0, 1).require("error_correction", error_correction);
  Range::openLow(0, 4).require("min_perimeter", min_perimeter);
}

std::unique_ptr<MarkerDetector> makeMarkerDetector(const DetectorParams& params) {
  params.validate();
  const bool tracking = params.search == "tracking";
  std::vector<MarkerTracker> trackers;
  std::vector<std::string> tags;
  for (const auto& family : params.families) {
    if (isArucoName(family))
      trackers.emplace_back(makeArucoSearch(params, family), tracking, params.refine_corners);
    else
      tags.push_back(family);
  }
  if (!tags.empty()) trackers.emplace_back(makeAprilTagSearch(params, tags), tracking, params.refine_corners);
  return std::make_unique<TrackingDetector>(std::move(trackers));
}

}  // namespace sextant
