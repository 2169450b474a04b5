// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/core/marker_detector.hpp"

#include <set>
#include <stdexcept>

#include "apriltag_detector.hpp"
#include "aruco_detector.hpp"
#include "sextant/core/marker_family.hpp"
#include "sextant/core/range.hpp"

namespace sextant {
namespace {

// Not a family's canonical name but the asked one tells the backend: DICT_APRILTAG_36h11 is read by OpenCV.
bool isArucoName(const std::string& name) { return name.rfind("DICT_", 0) == 0; }

class CombinedDetector : public MarkerDetector {
 public:
  explicit CombinedDetector(std::vector<std::unique_ptr<MarkerDetector>> parts) : parts_(std::move(parts)) {}

  std::vector<Detection> detect(const cv::Mat& image, const CameraModel* camera) override {
    if (image.type() != CV_8UC1 || image.empty())
      throw std::invalid_argument("MarkerDetector: the image must be 8-bit grey and not empty");
    std::vector<Detection> all;
    for (const auto& part : parts_) {
      auto found = part->detect(image, camera);
      all.insert(all.end(), std::make_move_iterator(found.begin()), std::make_move_iterator(found.end()));
    }
    return all;
  }

 private:
  std::vector<std::unique_ptr<MarkerDetector>> parts_;
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
  Range::closed(1, 64).require("threads", threads);
  Range::closed(1, 8).require("decimate", decimate);
  Range::closed(0, 3).require("max_hamming", max_hamming);
  Range::closed(0, 255).require("min_decision_margin", min_decision_margin);
  Range::closed(0, 1).require("error_correction", error_correction);
  Range::openLow(0, 4).require("min_perimeter", min_perimeter);
}

std::unique_ptr<MarkerDetector> makeMarkerDetector(const DetectorParams& params) {
  params.validate();
  std::vector<std::unique_ptr<MarkerDetector>> parts;
  std::vector<std::string> tags;
  for (const auto& family : params.families) {
    if (isArucoName(family))
      parts.push_back(makeArucoDetector(params, family));
    else
      tags.push_back(family);
  }
  if (!tags.empty()) parts.push_back(makeAprilTagDetector(params, tags));
  return std::make_unique<CombinedDetector>(std::move(parts));
}

}  // namespace sextant
