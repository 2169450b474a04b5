// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/core/marker_detector.hpp"

#include <set>
#include <stdexcept>

#include "apriltag_search.hpp"
#include "aruco_search.hpp"
#include "marker_tracks.hpp"
#include "sextant/core/marker_family.hpp"
#include "sextant/core/range.hpp"

namespace sextant {
namespace {

// Not a family's canonical name but the asked one tells the backend: DICT_APRILTAG_36h11 is read by OpenCV.
bool isArucoName(const std::string& name) { return name.rfind("DICT_", 0) == 0; }

constexpr int kSweep = 3;       // images within which a marker anywhere is found
constexpr int kSweepBlock = 5;  // pixels, see QuadSearch

cv::Rect boundingBox(const Corners& corners) {
  Eigen::Vector2d low = corners[0], high = corners[0];
  for (const auto& corner : corners) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  const cv::Point2d begin(low.x(), low.y()), end(high.x(), high.y());
  return {cv::Point(begin), cv::Point(end) + cv::Point(1, 1)};
}

// One backend, and what is remembered from image to image.
class Searcher {
 public:
  Searcher(std::unique_ptr<MarkerSearch> search, bool tracking)
      : search_(std::move(search)), tracking_(tracking) {}

  const MarkerSearch& backend() const { return *search_; }

  std::vector<Detection> find(const cv::Mat& image) {
    FoundMarkers found;
    if (!tracking_ || image.size() != size_) {
      size_ = image.size();
      tracks_.clear();
      search_->everywhere(image, found);
    } else {
      track(image, found);
    }
    if (tracking_) tracks_.update(found);
    return std::move(found.markers);
  }

 private:
  void track(const cv::Mat& image, FoundMarkers& found) {
    const auto expected = tracks_.expect(image.size());
    for (const auto& marker : expected)
      if (!lookFor(marker, marker.margin, Effort::quick, image, found))
        lookFor(marker, 3 * marker.margin, Effort::thorough, image, found);
    const bool view_changed = !expected.empty() && found.markers.empty();
    if (++since_sweep_ >= kSweep || view_changed)
      sweep(image, {{0, 0}, image.size()}, found);
    else
      for (const cv::Rect& strip : tracks_.entrances(image.size())) sweep(image, strip, found);
  }

  bool lookFor(const MarkerTracks::Expected& marker, double margin, Effort effort, const cv::Mat& image,
               FoundMarkers& found) {
    if (found.include(marker.key, marker.corners)) return true;
    const cv::Rect window = widened(boundingBox(marker.corners), margin, image.size());
    search_->within(image, window, shortestSide(marker.corners), effort, found);
    return found.include(marker.key, marker.corners);
  }

  void sweep(const cv::Mat& image, const cv::Rect& part, FoundMarkers& found) {
    if (part.size() == image.size()) since_sweep_ = 0;
    readQuads(quads_.find(image, part, search_->minSide(image.size()), {kSweepBlock}), image, *search_,
              Effort::quick, found);
  }

  std::unique_ptr<MarkerSearch> search_;
  bool tracking_;
  cv::Size size_;
  MarkerTracks tracks_;
  QuadSearch quads_;
  int since_sweep_ = 0;
};

class SearchingDetector : public MarkerDetector {
 public:
  SearchingDetector(std::vector<Searcher> searchers, bool refine)
      : searchers_(std::move(searchers)), refine_(refine) {}

  std::vector<Detection> detect(const cv::Mat& image, const CameraModel* camera) override {
    if (image.type() != CV_8UC1 || image.empty())
      throw std::invalid_argument("MarkerDetector: the image must be 8-bit grey and not empty");
    std::vector<Detection> all;
    for (Searcher& searcher : searchers_)
      for (Detection& found : searcher.find(image)) {
        if (refine_) refine(image, searcher.backend().border(found.key), camera, found);
        all.push_back(std::move(found));
      }
    return all;
  }

 private:
  static void refine(const cv::Mat& image, BorderSquare border, const CameraModel* camera, Detection& found) {
    border.start_sigma = found.corner_sigmas[0];
    const RefinedCorners refined = refineCorners(image, found.corners, border, camera);
    found.corners = refined.corners;
    found.corner_sigmas = refined.sigmas;
  }

  std::vector<Searcher> searchers_;
  bool refine_;
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
  std::vector<Searcher> searchers;
  std::vector<std::string> tags;
  for (const auto& family : params.families) {
    if (isArucoName(family))
      searchers.emplace_back(makeArucoSearch(params, family), tracking);
    else
      tags.push_back(family);
  }
  if (!tags.empty()) searchers.emplace_back(makeAprilTagSearch(params, tags), tracking);
  return std::make_unique<SearchingDetector>(std::move(searchers), params.refine_corners);
}

}  // namespace sextant
