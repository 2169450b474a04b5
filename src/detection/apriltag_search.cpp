// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "apriltag_reader.hpp"
#include "marker_search.hpp"
#include "sextant/markers/apriltag_family.hpp"

namespace sextant {
namespace {

constexpr double kQuadSigma = 0.3;         // pixels; standard deviation of its corner coordinates
constexpr double kTagContourSigma = 0.75;  // the same of those of a contour
constexpr double kCoarseSigma = 0.25;      // the same over the factor by which the image is reduced
constexpr double kMaxTableBytes = 1e9;     // of the table of corrected codes
constexpr double kBytesPerCode = 3 * 16;   // libapriltag's hash table has three 16-byte slots per code

constexpr double kMinTagModule = 1.4;     // pixels; smaller modules cannot be read
constexpr double kFineSharpening = 0.25;  // of the bits; libapriltag's default

// A code that random bits match more often than this needs a clear print: see TagReading. Chosen on every
// second photo of a corridor and of streets without tags, where these limits leave none of 115 false tag16h5;
// with 1e-4, one false tag36h11 with two wrong bits appeared in 1800 images of the simulated room.
constexpr double kMaxChance = 1e-5;
constexpr double kMinBorder = 0.95, kMinClarity = 0.7;
constexpr double kSomeBorder = 0.6;  // of a quad that is worth a search
constexpr double kBlurred = 0.15;    // minimum clarity of blurred bits; texture has less
constexpr double kSharp = 0.9;       // minimum clarity of bits that are certain

// A second scale for blurred tags: edges as wide as modules are found in an image reduced by kCoarse only,
// and modules that run into one another are read when they are sharpened more.
constexpr double kCoarse = 4, kCoarseSharpening = 2;
#if __has_include(<apriltag/tag36h10.h>)
constexpr int kMinWidth = 0;
#else
// Decimated pixels. libapriltag 0.10 of Debian 11 corrupts memory if there are less than 51200 in all.
constexpr int kMinWidth = 227;
#endif
constexpr double kLarge = 64;          // pixels; quads with a larger side are searched at half resolution
constexpr double kSmallestPart = 0.5;  // of the expected side
constexpr double kSmall = 24;  // pixels of the decimated image; those with a smaller one at full resolution

// Number of codes that differ from a given one in at most so many bits.
double neighbours(const apriltag_family_t& family, int bits) {
  double codes = 0, combinations = 1;
  for (int k = 0; k <= bits; ++k) {
    codes += combinations;
    combinations *= static_cast<double>(family.nbits - k) / (k + 1);
  }
  return codes;
}

// Probability that random bits are one of the codes, turned any way, with this number of wrong bits or fewer.
double chance(const apriltag_family_t& family, int hamming) {
  return 4 * family.ncodes * neighbours(family, hamming) / std::exp2(family.nbits);
}

// libapriltag stores every code with up to `corrected` flipped bits.
void checkTable(const std::string& name, const apriltag_family_t& family, int corrected) {
  const double codes = family.ncodes * neighbours(family, corrected);
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
      readers_.emplace_back(*families_.back());
      checkTable(name, *families_.back(), params.max_hamming);
      for (const Detector& detector : {std::cref(whole_), std::cref(part_)})
        apriltag_detector_add_family_bits(detector.get(), families_.back().get(), params.max_hamming);
    }
  }

  void everywhere(const cv::Mat& image, FoundMarkers& found) override {
    detect(*whole_, image, {0, 0}, {params_.decimate, kFineSharpening}, found);
    coarsely(*whole_, image, {0, 0}, found);
    blurredIn(image, {{0, 0}, image.size()}, minSide(image.size()), found);
  }

  // Most tags can be read between the corners of their contour, without libapriltag.
  void inside(const cv::Mat& image, QuadSearch& quads, Effort effort, FoundMarkers& found) override {
    for (const QuadCandidate& quad : quads.distinct()) {
      if (found.cover(quad)) continue;
      if (const auto tag = identify(image, quad))
        found.add(*tag);
      else if (mayBeTag(image, quad))
        within(image, windowOf(quad, image.size()), quad.side, effort, found);
    }
  }

  void within(const cv::Mat& image, const cv::Rect& window, double side, Effort effort,
              FoundMarkers& found) override {
    const cv::Mat part = image(window);
    const size_t before = found.markers.size();
    detect(*part_, part, window.tl(), {decimation(image, window, side, effort), kFineSharpening}, found);
    if (effort == Effort::quick || found.markers.size() > before) return;
    coarsely(*part_, part, window.tl(), found);
    blurredIn(image, window, kSmallestPart * side, found);
  }

  bool readAt(const cv::Mat& image, Detection& marker) override {
    const auto reading = readers_[indexOf(marker.key)].read(image, marker.key.id, marker.corners);
    if (!reading) return false;
    marker.hamming = reading->hamming;
    marker.decision_margin = reading->margin;
    if (isClear(marker, reading)) return true;
    return isBlurred(marker, *reading) &&
           readers_[indexOf(marker.key)].resembles(image, marker.key.id, marker.corners);
  }

  bool readsInPlace() const override { return true; }

  double minSide(const cv::Size&) const override {
    double modules = 0;
    for (const auto& family : families_) modules = std::max(modules, 1.0 * family->width_at_border);
    return kMinTagModule * modules;
  }

  BorderSquare border(const MarkerKey& key) const override {
    const auto& family = families_[indexOf(key)];
    return {family->width_at_border, family->reversed_border};
  }

 private:
  struct Scale {
    double decimate, sharpening;
  };

  size_t indexOf(const MarkerKey& key) const {
    for (size_t i = 0; i < families_.size(); ++i)
      if (key.family == families_[i]->name) return i;
    throw std::logic_error("AprilTagSearch: family " + key.family + " is not configured");
  }

  double decimation(const cv::Mat& image, const cv::Rect& window, double side, Effort effort) const {
    if (side < kSmall * params_.decimate) return 1;
    // At the border the white margin may be narrower than libapriltag's tiles of four decimated pixels.
    const bool coarse = side > kLarge && effort == Effort::quick && !touchesBorder(window, image.size());
    return std::max(params_.decimate, coarse ? 2.0 : 1.0);
  }

  void blurredIn(const cv::Mat& image, const cv::Rect& part, double min_side, FoundMarkers& found) {
    quads_.find(image, part, min_side, Effort::thorough);
    for (const QuadCandidate& quad : quads_.distinct()) {
      if (found.cover(quad)) continue;
      if (const auto tag = identify(image, quad)) found.add(*tag);
    }
  }

  static Corners cornersOf(const QuadCandidate& quad) {
    Corners corners;
    for (int i = 0; i < 4; ++i) corners[i] = {quad.corners[i].x, quad.corners[i].y};
    return corners;
  }

  // Whether the quad has the border of a tag. Of a white border, the quad may be the other edge of the black
  // one.
  bool mayBeTag(const cv::Mat& image, const QuadCandidate& quad) const {
    for (size_t i = 0; i < readers_.size(); ++i)
      if (families_[i]->reversed_border || readers_[i].border(image, cornersOf(quad)) >= kSomeBorder)
        return true;
    return false;
  }

  std::optional<Detection> identify(const cv::Mat& image, const QuadCandidate& quad) const {
    if (params_.max_hamming == 0) return std::nullopt;
    const Corners corners = cornersOf(quad);
    for (size_t i = 0; i < readers_.size(); ++i) {
      const auto match = readers_[i].identify(image, corners);
      if (!match) continue;
      Detection tag;
      tag.key = {families_[i]->name, match->id};
      for (int k = 0; k < 4; ++k) tag.corners[k] = corners[(k + match->rotation) % 4];
      tag.corner_sigmas.fill(kTagContourSigma);
      const auto reading = readers_[i].read(image, match->id, tag.corners);
      tag.hamming = reading->hamming;
      tag.decision_margin = reading->margin;
      if (isClear(tag, reading) || isBlurred(tag, *reading)) return tag;
    }
    return std::nullopt;
  }

  void coarsely(apriltag_detector_t& detector, const cv::Mat& image, const cv::Point& origin,
                FoundMarkers& found) const {
    if (params_.decimate >= kCoarse) return;
    FoundMarkers blurred;
    detect(detector, image, origin, {kCoarse, kCoarseSharpening}, blurred);
    for (const Detection& marker : blurred.markers)
      if (!found.include(marker.key, marker.corners)) found.add(marker);
  }

  void detect(apriltag_detector_t& detector, const cv::Mat& image, const cv::Point& origin,
              const Scale& scale, FoundMarkers& found) const {
    const double min_side = 16 * scale.decimate;  // libapriltag divides by the number of its 4-pixel tiles
    if (image.cols < min_side || image.rows < min_side) return;
    detector.quad_decimate = static_cast<float>(scale.decimate);
    detector.decode_sharpening = scale.sharpening;
    const cv::Mat padded = atLeast(static_cast<int>(kMinWidth * scale.decimate), image);
    image_u8_t view{padded.cols, padded.rows, static_cast<int>(padded.step), padded.data};
    const std::unique_ptr<zarray_t, void (*)(zarray_t*)> tags(apriltag_detector_detect(&detector, &view),
                                                              apriltag_detections_destroy);
    for (int i = 0; i < zarray_size(tags.get()); ++i) {
      apriltag_detection_t* tag;
      zarray_get(tags.get(), i, &tag);
      Detection marker = detection(*tag);
      const auto reading = readers_[indexOf(marker.key)].read(image, marker.key.id, marker.corners);
      if (reading) marker.decision_margin = reading->margin;  // libapriltag's depends on the sharpening
      if (!isClear(marker, reading)) continue;
      marker.corner_sigmas.fill(std::max(kQuadSigma, kCoarseSigma * scale.decimate));
      for (auto& corner : marker.corners) corner += Eigen::Vector2d(origin.x, origin.y);
      found.add(marker);
    }
  }

  bool isClear(const Detection& tag, const std::optional<TagReading>& reading) const {
    if (tag.hamming > params_.max_hamming || tag.decision_margin < params_.min_decision_margin) return false;
    if (chance(*families_[indexOf(tag.key)], tag.hamming) <= kMaxChance) return true;
    return reading && reading->border >= kMinBorder && reading->clarity >= kMinClarity;
  }

  // Whether the CodeBook decides: the bits of a clear print are those that it shows.
  bool isBlurred(const Detection& tag, const TagReading& reading) const {
    return params_.max_hamming > 0 && tag.decision_margin >= params_.min_decision_margin &&
           reading.clarity >= kBlurred && reading.clarity < kSharp;
  }

  // libapriltag's corners are counterclockwise from the bottom left; its origin is the corner of the first
  // pixel.
  static Detection detection(const apriltag_detection_t& tag) {
    Detection found;
    found.key = {tag.family->name, tag.id};
    for (int i = 0; i < 4; ++i) found.corners[i] = {tag.p[3 - i][0] - 0.5, tag.p[3 - i][1] - 0.5};
    found.hamming = tag.hamming;
    found.decision_margin = tag.decision_margin;
    return found;
  }

  DetectorParams params_;
  std::vector<AprilTagFamily> families_;  // before the detectors, which point to them
  std::vector<AprilTagReader> readers_;   // of the same families
  Detector whole_, part_;
  QuadSearch quads_;
};

}  // namespace

std::unique_ptr<MarkerSearch> makeAprilTagSearch(const DetectorParams& params,
                                                 const std::vector<std::string>& families) {
  return std::make_unique<AprilTagSearch>(params, families);
}

}  // namespace sextant
