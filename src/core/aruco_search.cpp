// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "aruco_search.hpp"

#include <algorithm>
#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>

#include "aruco_dictionary.hpp"
#include "sextant/core/marker_family.hpp"

namespace sextant {
namespace {

constexpr double kRawSigma = 0.75;  // pixels of what is read, of a coordinate of a contour's corner
constexpr int kMinWindow = 16;      // pixels; no marker can be read in a smaller image
constexpr double kMinModule = 1.4;  // pixels; no module can be read in fewer
constexpr double kEnough = 5;       // pixels a module; what has twice as many is read in a smaller image
constexpr double kSmoothing = 0.6;  // pixels; less noise makes fewer contours
constexpr int kBlock = 9, kSmallBlock = 3, kLargeBlock = 13;  // pixels whose mean is the threshold
constexpr double kSmallerThanExpected = 0.5;

cv::Ptr<cv::aruco::DetectorParameters> arucoParameters(const DetectorParams& params) {
  auto aruco = cv::aruco::DetectorParameters::create();
  aruco->errorCorrectionRate = params.error_correction;
  aruco->adaptiveThreshWinSizeStep = kLargeBlock - kSmallBlock;
  aruco->minMarkerDistanceRate = 0.02;  // a white border one module wide: with 0.05 the outer contour wins
  aruco->minDistanceToBorder = 1;
  aruco->cornerRefinementMethod = cv::aruco::CORNER_REFINE_NONE;
  return aruco;
}

class ArucoSearch : public MarkerSearch {
 public:
  ArucoSearch(const DetectorParams& params, const std::string& name)
      : min_perimeter_(params.min_perimeter),
        family_(canonicalFamily(name)),
        turn_(family_ == name ? 0 : 2),
        dictionary_(makeArucoDictionary(name)),
        parameters_(arucoParameters(params)) {}

  void everywhere(const cv::Mat& image, FoundMarkers& found) override {
    readQuads(quads_.find(image, {{0, 0}, image.size()}, minSide(image.size()), Effort::thorough), image,
              *this, Effort::thorough, found);
  }

  void within(const cv::Mat& image, const cv::Rect& window, double side, Effort effort,
              FoundMarkers& found) override {
    if (window.width < kMinWindow || window.height < kMinWindow) return;
    // Beside the border the white may be too narrow to be seen in a much smaller image.
    const bool fine = effort == Effort::thorough && touchesBorder(window, image.size());
    const int scale = prepare(image(window), fine ? side / 2 : side);
    parameters_->adaptiveThreshWinSizeMin = effort == Effort::quick ? kBlock : kSmallBlock;
    parameters_->adaptiveThreshWinSizeMax = effort == Effort::quick ? kBlock : kLargeBlock;
    const double min_side = std::max(kSmallerThanExpected * side, minSide(image.size()));
    parameters_->minMarkerPerimeterRate = 4 * min_side / scale / std::max(prepared_.cols, prepared_.rows);
    cv::aruco::detectMarkers(prepared_, dictionary_, read_, ids_, parameters_);
    for (size_t i = 0; i < ids_.size(); ++i) found.add(detection(ids_[i], read_[i], window.tl(), scale));
  }

  double minSide(const cv::Size& image) const override {
    return std::max(0.25 * min_perimeter_ * std::max(image.width, image.height),
                    kMinModule * (dictionary_->markerSize + 2));
  }

  BorderSquare border(const MarkerKey&) const override { return {dictionary_->markerSize + 2, false}; }

 private:
  /// By how much the window was made smaller.
  int prepare(const cv::Mat& window, double side) {
    const double enough = kEnough * (dictionary_->markerSize + 2);
    if (side < 2 * enough) {
      cv::GaussianBlur(window, buffer_, {3, 3}, kSmoothing, 0, cv::BORDER_DEFAULT | cv::BORDER_ISOLATED);
      prepared_ = buffer_;
      return 1;
    }
    int scale = 2;
    halve(window, buffer_);
    for (; side >= 2 * enough * scale; scale *= 2) {
      halve(buffer_, smaller_);
      std::swap(buffer_, smaller_);
    }
    prepared_ = buffer_;
    return scale;
  }

  Detection detection(int id, const std::vector<cv::Point2f>& quad, const cv::Point& origin,
                      int scale) const {
    Detection found;
    found.key = {family_, id};
    found.corner_sigmas.fill(kRawSigma * scale);
    for (int i = 0; i < 4; ++i) {
      const cv::Point2f& corner = quad[(i + turn_) % 4];
      found.corners[i] = {origin.x + (corner.x + 0.5) * scale - 0.5,
                          origin.y + (corner.y + 0.5) * scale - 0.5};
    }
    return found;
  }

  double min_perimeter_;
  std::string family_;
  int turn_;  // corners by which the dictionary's upright is turned against the canonical print's
  cv::Ptr<cv::aruco::Dictionary> dictionary_;
  cv::Ptr<cv::aruco::DetectorParameters> parameters_;
  QuadSearch quads_;
  cv::Mat buffer_, smaller_;
  cv::Mat prepared_;  // what is read: one of them, or the window itself
  std::vector<std::vector<cv::Point2f>> read_;
  std::vector<int> ids_;
};

}  // namespace

std::unique_ptr<MarkerSearch> makeArucoSearch(const DetectorParams& params, const std::string& dictionary) {
  return std::make_unique<ArucoSearch>(params, dictionary);
}

}  // namespace sextant
