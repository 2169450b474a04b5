// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "code_reader.hpp"
#include "marker_search.hpp"
#include "sextant/markers/aruco_dictionary.hpp"

namespace sextant {
namespace {

constexpr double kContourSigma = 0.75;   // pixels; deviation of a contour's corner coordinates
constexpr int kMinWindow = 16;           // pixels; no marker can be read in a smaller image
constexpr double kMinArucoModule = 1.4;  // pixels; smaller modules cannot be read
constexpr double kEnough = 10;           // pixels per module from which half the resolution suffices
constexpr double kEnoughQuickly = 6;     // the same for Effort::quick
constexpr double kSmoothing = 0.6;       // pixels; reduces the number of contours from noise
constexpr int kBlock = 9, kSmallBlock = 3, kLargeBlock = 13;  // pixels; window of the adaptive threshold
constexpr double kDarkBorder = 0.7;  // minimum dark fraction of the border for a thorough search
constexpr double kMinDeviation = 1;  // grey levels; of a square that can have a code, in poor light
constexpr double kSmallerThanExpected = 0.5;

cv::aruco::DetectorParameters arucoParameters(const DetectorParams& params) {
  cv::aruco::DetectorParameters aruco;
  aruco.errorCorrectionRate = params.error_correction;
  aruco.adaptiveThreshWinSizeStep = kLargeBlock - kSmallBlock;
  aruco.minMarkerDistanceRate = 0.02;  // with 0.05, the outer contour of a one-module white border wins
  aruco.minDistanceToBorder = 1;
  aruco.minOtsuStdDev = kMinDeviation;
  aruco.cornerRefinementMethod = cv::aruco::CORNER_REFINE_NONE;
  return aruco;
}

class ArucoSearch : public MarkerSearch {
 public:
  ArucoSearch(const DetectorParams& params, const std::string& name)
      : min_perimeter_(params.min_perimeter),
        family_(name),
        dictionary_(makeArucoDictionary(name)),
        parameters_(arucoParameters(params)),
        reader_(dictionary_, parameters_) {}

  void everywhere(const cv::Mat& image, FoundMarkers& found) override {
    quads_.find(image, {{0, 0}, image.size()}, minSide(image.size()), Effort::thorough);
    inside(image, quads_, Effort::thorough, found);
  }

  void inside(const cv::Mat& image, QuadSearch& quads, Effort effort, FoundMarkers& found) override {
    for (const QuadCandidate& quad : quads.all()) {
      if (found.cover(quad)) continue;
      const Code code = reader_.read(image, quad.corners);
      if (code.id >= 0)
        found.add(detection(code, quad));
      else if (code.dark_border >= kDarkBorder && quad.side < enough(effort) * (dictionary_.markerSize + 2))
        closeUp(image, windowOf(quad, image.size()), quad.side, effort, found);
    }
  }

  void within(const cv::Mat& image, const cv::Rect& window, double side, Effort effort,
              FoundMarkers& found) override {
    quads_.find(image, window, std::max(kSmallerThanExpected * side, minSide(image.size())), effort);
    inside(image, quads_, effort, found);
  }

  bool readAt(const cv::Mat& image, Detection& marker) override {
    std::array<cv::Point2f, 4> quad;
    for (int i = 0; i < 4; ++i)
      quad[i] = {static_cast<float>(marker.corners[i].x()), static_cast<float>(marker.corners[i].y())};
    return reader_.shows(image, quad, marker.key.id);
  }

  bool readsInPlace() const override { return true; }

  double minSide(const cv::Size& image) const override {
    return std::max(0.25 * min_perimeter_ * std::max(image.width, image.height),
                    kMinArucoModule * (dictionary_.markerSize + 2));
  }

  BorderSquare border(const MarkerKey&) const override { return {dictionary_.markerSize + 2, false}; }

 private:
  static double enough(Effort effort) { return effort == Effort::quick ? kEnoughQuickly : kEnough; }

  /// Searches with contours from the full resolution.
  void closeUp(const cv::Mat& image, const cv::Rect& window, double side, Effort effort,
               FoundMarkers& found) {
    if (window.width < kMinWindow || window.height < kMinWindow) return;
    cv::GaussianBlur(image(window), smooth_, {3, 3}, kSmoothing, 0, cv::BORDER_DEFAULT | cv::BORDER_ISOLATED);
    cv::normalize(smooth_, smooth_, 0, 255, cv::NORM_MINMAX);
    parameters_.adaptiveThreshWinSizeMin = effort == Effort::quick ? kBlock : kSmallBlock;
    parameters_.adaptiveThreshWinSizeMax = effort == Effort::quick ? kBlock : kLargeBlock;
    const double min_side = std::max(kSmallerThanExpected * side, minSide(image.size()));
    parameters_.minMarkerPerimeterRate = 4 * min_side / std::max(window.width, window.height);
    detectArucoMarkers(smooth_, dictionary_, parameters_, read_, ids_);
    for (size_t i = 0; i < ids_.size(); ++i)
      if (reader_.trusts(smooth_, {read_[i][0], read_[i][1], read_[i][2], read_[i][3]}))
        found.add(detection(ids_[i], read_[i], window.tl()));
  }

  Detection detection(const Code& code, const QuadCandidate& quad) const {
    std::vector<cv::Point2f> corners(quad.corners.begin(), quad.corners.end());
    std::rotate(corners.begin(), corners.begin() + (4 - code.rotation) % 4, corners.end());
    return detection(code.id, corners, {0, 0});
  }

  Detection detection(int id, const std::vector<cv::Point2f>& quad, const cv::Point& origin) const {
    Detection found;
    found.key = {family_, id};
    found.corner_sigmas.fill(kContourSigma);
    for (int i = 0; i < 4; ++i) found.corners[i] = {origin.x + quad[i].x, origin.y + quad[i].y};
    return found;
  }

  double min_perimeter_;
  std::string family_;
  cv::aruco::Dictionary dictionary_;
  cv::aruco::DetectorParameters parameters_;
  CodeReader reader_;
  QuadSearch quads_;
  cv::Mat smooth_;
  std::vector<std::vector<cv::Point2f>> read_;
  std::vector<int> ids_;
};

}  // namespace

std::unique_ptr<MarkerSearch> makeArucoSearch(const DetectorParams& params, const std::string& dictionary) {
  return std::make_unique<ArucoSearch>(params, dictionary);
}

}  // namespace sextant
