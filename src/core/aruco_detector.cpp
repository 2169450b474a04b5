// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "aruco_detector.hpp"

#include <algorithm>
#include <opencv2/aruco.hpp>

#include "aruco_dictionary.hpp"
#include "sextant/core/corner_refiner.hpp"
#include "sextant/core/marker_family.hpp"

namespace sextant {
namespace {

constexpr double kRawSigma = 0.75;  // pixels, of a coordinate of a contour's corner
constexpr int kMinSide = 16;        // pixels; no marker can be read in a smaller image

cv::Ptr<cv::aruco::DetectorParameters> arucoParameters(const DetectorParams& params) {
  auto aruco = cv::aruco::DetectorParameters::create();
  aruco->minMarkerPerimeterRate = params.min_perimeter;
  aruco->errorCorrectionRate = params.error_correction;
  aruco->minMarkerDistanceRate = 0.02;  // a white border one module wide: with 0.05 the outer contour wins
  aruco->cornerRefinementMethod = cv::aruco::CORNER_REFINE_NONE;
  return aruco;
}

Eigen::Vector2d centre(const Corners& corners) {
  return 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
}

double perimeter(const Corners& corners) {
  double sum = 0;
  for (int i = 0; i < 4; ++i) sum += (corners[i] - corners[(i + 1) % 4]).norm();
  return sum;
}

class ArucoDetector : public MarkerDetector {
 public:
  ArucoDetector(const DetectorParams& params, const std::string& name)
      : family_(canonicalFamily(name)),
        turn_(family_ == name ? 0 : 2),
        refine_(params.refine_corners),
        dictionary_(makeArucoDictionary(name)),
        parameters_(arucoParameters(params)) {}

  std::vector<Detection> detect(const cv::Mat& image, const CameraModel* camera) override {
    if (image.cols < kMinSide || image.rows < kMinSide) return {};
    std::vector<std::vector<cv::Point2f>> quads;
    std::vector<int> ids;
    cv::aruco::detectMarkers(image, dictionary_, quads, ids, parameters_);
    std::vector<Detection> detections;
    for (size_t i = 0; i < ids.size(); ++i) add(detection(ids[i], quads[i]), detections);
    for (Detection& found : detections) refine(image, camera, found);
    return detections;
  }

 private:
  Detection detection(int id, const std::vector<cv::Point2f>& quad) const {
    Detection found;
    found.key = {family_, id};
    for (int i = 0; i < 4; ++i) {
      const cv::Point2f& corner = quad[(i + turn_) % 4];
      found.corners[i] = {corner.x, corner.y};
    }
    return found;
  }

  // A marker can be found on both sides of its edge (at two threshold windows): the larger quad is the
  // border's.
  void add(const Detection& found, std::vector<Detection>& detections) const {
    for (Detection& other : detections) {
      const double larger = std::max(perimeter(found.corners), perimeter(other.corners));
      if (!(other.key == found.key) || (centre(found.corners) - centre(other.corners)).norm() > larger / 8)
        continue;
      if (perimeter(found.corners) > perimeter(other.corners)) other = found;
      return;
    }
    detections.push_back(found);
  }

  void refine(const cv::Mat& image, const CameraModel* camera, Detection& found) const {
    if (!refine_) return;
    const BorderSquare square{dictionary_->markerSize + 2, false, kRawSigma};
    const RefinedCorners refined = refineCorners(image, found.corners, square, camera);
    found.corners = refined.corners;
    found.corner_sigmas = refined.sigmas;
  }

  std::string family_;
  int turn_;  // corners by which the dictionary's upright is turned against the canonical print's
  bool refine_;
  cv::Ptr<cv::aruco::Dictionary> dictionary_;
  cv::Ptr<cv::aruco::DetectorParameters> parameters_;
};

}  // namespace

std::unique_ptr<MarkerDetector> makeArucoDetector(const DetectorParams& params,
                                                  const std::string& dictionary) {
  return std::make_unique<ArucoDetector>(params, dictionary);
}

}  // namespace sextant
