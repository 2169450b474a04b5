// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apriltag_search.hpp"

#include <algorithm>
#include <functional>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "sextant/markers/apriltag_family.hpp"

namespace sextant {
namespace {

constexpr double kQuadSigma = 0.3;        // pixels; standard deviation of its corner coordinates
constexpr double kMaxTableBytes = 1e9;    // of the table of corrected codes
constexpr double kBytesPerCode = 3 * 16;  // libapriltag's hash table has three 16-byte slots per code

constexpr double kMinTagModule = 2;  // pixels of the decimated image; smaller modules cannot be read
#if __has_include(<apriltag/tag36h10.h>)
constexpr int kMinWidth = 0;
#else
// Decimated pixels. libapriltag 0.10 of Debian 11 corrupts memory if there are less than 51200 in all.
constexpr int kMinWidth = 227;
#endif
constexpr double kLarge = 64;  // pixels; quads with a larger side are searched at half resolution

// libapriltag stores every code with up to `corrected` flipped bits.
void checkTable(const std::string& name, const apriltag_family_t& family, int corrected) {
  double codes = 0, combinations = 1;
  for (int k = 0; k <= corrected; ++k) {
    codes += combinations * family.ncodes;
    combinations *= static_cast<double>(family.nbits - k) / (k + 1);
  }
  if (codes * kBytesPerCode > kMaxTableBytes)
    throw std::invalid_argument("max_hamming " + std::to_string(corrected) + " needs " +
                                std::to_string(static_cast<int>(codes * kBytesPerCode / 1e6)) + " MB for " +
                                name + "; set it to " + std::to_string(corrected - 1));
}

// The image itself if it is large enough, else a copy that its last pixels continue to the right and below.
cv::Mat atLeast(int width, const cv::Mat& image) {
  if (image.cols >= width && image.rows >= width) return image;
  cv::Mat padded;
  cv::copyMakeBorder(image, padded, 0, std::max(0, width - image.rows), 0, std::max(0, width - image.cols),
                     cv::BORDER_REPLICATE);
  return padded;
}

using Detector = std::unique_ptr<apriltag_detector_t, void (*)(apriltag_detector_t*)>;

Detector makeDetector(int threads) {
  Detector detector(apriltag_detector_create(), apriltag_detector_destroy);
  detector->nthreads = threads;
  return detector;
}

class AprilTagSearch : public MarkerSearch {
 public:
  AprilTagSearch(const DetectorParams& params, const std::vector<std::string>& names)
      : params_(params), whole_(makeDetector(params.threads)), part_(makeDetector(1)) {
    for (const std::string& name : names) {
      families_.push_back(makeAprilTagFamily(name));
      checkTable(name, *families_.back(), params.max_hamming);
      for (const Detector& detector : {std::cref(whole_), std::cref(part_)})
        apriltag_detector_add_family_bits(detector.get(), families_.back().get(), params.max_hamming);
    }
  }

  void everywhere(const cv::Mat& image, FoundMarkers& found) override {
    detect(*whole_, image, params_.decimate, {0, 0}, found);
  }

  void within(const cv::Mat& image, const cv::Rect& window, double side, Effort effort,
              FoundMarkers& found) override {
    // At the border the white margin may be narrower than libapriltag's tiles of four decimated pixels.
    const bool coarse = side > kLarge && effort == Effort::quick && !touchesBorder(window, image.size());
    const double decimate = std::max(params_.decimate, coarse ? 2.0 : 1.0);
    detect(*part_, image(window), decimate, window.tl(), found);
  }

  double minSide(const cv::Size&) const override {
    double modules = 0;
    for (const auto& family : families_) modules = std::max(modules, 1.0 * family->width_at_border);
    return kMinTagModule * modules * params_.decimate;
  }

  BorderSquare border(const MarkerKey& key) const override {
    for (const auto& family : families_)
      if (key.family == family->name) return {family->width_at_border, family->reversed_border};
    throw std::logic_error("AprilTagSearch::border: family " + key.family + " is not configured");
  }

 private:
  void detect(apriltag_detector_t& detector, const cv::Mat& image, double decimate, const cv::Point& origin,
              FoundMarkers& found) const {
    const double min_side = 16 * decimate;  // libapriltag divides by the number of its 4-pixel tiles
    if (image.cols < min_side || image.rows < min_side) return;
    detector.quad_decimate = static_cast<float>(decimate);
    const cv::Mat padded = atLeast(static_cast<int>(kMinWidth * decimate), image);
    image_u8_t view{padded.cols, padded.rows, static_cast<int>(padded.step), padded.data};
    const std::unique_ptr<zarray_t, void (*)(zarray_t*)> tags(apriltag_detector_detect(&detector, &view),
                                                              apriltag_detections_destroy);
    for (int i = 0; i < zarray_size(tags.get()); ++i) {
      apriltag_detection_t* tag;
      zarray_get(tags.get(), i, &tag);
      if (tag->hamming <= params_.max_hamming && tag->decision_margin >= params_.min_decision_margin)
        found.add(detection(*tag, origin));
    }
  }

  // libapriltag's corners are counterclockwise from the bottom left; its origin is the corner of the first
  // pixel.
  static Detection detection(const apriltag_detection_t& tag, const cv::Point& origin) {
    Detection found;
    found.key = {tag.family->name, tag.id};
    for (int i = 0; i < 4; ++i)
      found.corners[i] = {origin.x + tag.p[3 - i][0] - 0.5, origin.y + tag.p[3 - i][1] - 0.5};
    found.corner_sigmas.fill(kQuadSigma);
    found.hamming = tag.hamming;
    found.decision_margin = tag.decision_margin;
    return found;
  }

  DetectorParams params_;
  std::vector<AprilTagFamily> families_;  // before the detectors, which point to them
  Detector whole_, part_;
};

}  // namespace

std::unique_ptr<MarkerSearch> makeAprilTagSearch(const DetectorParams& params,
                                                 const std::vector<std::string>& families) {
  return std::make_unique<AprilTagSearch>(params, families);
}

}  // namespace sextant
