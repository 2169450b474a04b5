// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/detection/marker_detector.hpp"

#include <set>
#include <stdexcept>

#include "marker_tracker.hpp"
#include "sextant/markers/marker_family.hpp"

namespace sextant {
namespace {

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

void requireFamilies(const Param& param) {
  const auto& families = *std::get<std::vector<std::string>*>(param.value);
  if (families.empty()) throw std::invalid_argument("families is empty: set at least one marker family");
  std::set<std::string> prints;
  try {
    for (const auto& family : families)
      if (!prints.insert(canonicalFamily(family)).second)
        throw std::invalid_argument("'" + family + "' is listed twice, or with both of its names");
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(std::string("families: ") + error.what());
  }
}

}  // namespace

ParamList DetectorParams::fields() {
  return {
      {"families", &families, Allowed("[families](#marker-families)", requireFamilies), "",
       "marker families to detect, e.g. `tag36h11` or `DICT_4X4_50`; `DICT_APRILTAG_...` are AprilTag "
       "families"},
      {"threads", &threads, Range::closed(1, 64), "",
       "number of threads of the AprilTag backend; with more than one, OpenCV also uses threads of its own"},
      {"search", &search, oneOf({"full", "tracking"}), "",
       "`tracking`: search known markers at their predicted positions, and new ones in every third image "
       "(faint ones in every 30th); in the others only at the sides of the image where new parts of the "
       "scene come into view; `full`: search every image completely, also at a coarser scale for motion "
       "blur, several times slower"},
      {"decimate", &decimate, Range::closed(1, 8), "",
       "AprilTag: factor by which the image is reduced for the quad search; 2 is 4 times as fast"},
      {"max_hamming", &max_hamming, Range::closed(0, 3), "bits",
       "AprilTag: maximum number of corrected bits; refused for large families if it needs more than 1 GB; "
       "0: blurred tags are not identified by their grey levels either"},
      {"min_decision_margin", &min_decision_margin, Range::closed(0, 255), "grey levels",
       "AprilTag: minimum contrast of the bits, also in poor light; false detections are rejected by their "
       "border "
       "and by contrast relative to it"},
      {"error_correction", &error_correction, Range::closed(0, 1), "",
       "ArUco: fraction of the dictionary's correctable bits that are corrected; 0: blurred markers are not "
       "identified by their grey levels either"},
      {"min_perimeter", &min_perimeter, Range::openLow(0, 4), "",
       "ArUco: minimum ratio of a marker's perimeter to the larger side of the image"},
      {"refine_corners", &refine_corners, Allowed(), "",
       "refine corners by fitting the edges in the full image with lens distortion, and estimate the "
       "standard deviation of each corner (large at occluded edges)"},
  };
}

std::unique_ptr<MarkerDetector> makeMarkerDetector(const DetectorParams& params) {
  validate(params);
  const bool tracking = params.search == "tracking";
  std::vector<MarkerTracker> trackers;
  std::vector<std::string> tags;
  for (const auto& name : params.families) {
    const std::string family = canonicalFamily(name);
    if (isAprilTag(family))
      tags.push_back(family);
    else
      trackers.emplace_back(makeArucoSearch(params, family), tracking, params.refine_corners);
  }
  if (!tags.empty()) trackers.emplace_back(makeAprilTagSearch(params, tags), tracking, params.refine_corners);
  return std::make_unique<TrackingDetector>(std::move(trackers));
}

}  // namespace sextant
