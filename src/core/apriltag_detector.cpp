// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apriltag_detector.hpp"

#include <stdexcept>

#include "apriltag_family.hpp"
#include "sextant/core/corner_refiner.hpp"

namespace sextant {
namespace {

constexpr double kRawSigma = 0.3;  // pixels, of a coordinate of libapriltag's corner where nothing is hidden
constexpr double kMaxTableBytes = 1e9;
constexpr double kBytesPerCode = 3 * 16;  // libapriltag's hash table has three 16-byte slots a code

// libapriltag keeps every code with up to `corrected` flipped bits.
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

class AprilTagDetector : public MarkerDetector {
 public:
  AprilTagDetector(const DetectorParams& params, const std::vector<std::string>& names)
      : params_(params), detector_(apriltag_detector_create(), apriltag_detector_destroy) {
    detector_->nthreads = params.threads;
    detector_->quad_decimate = static_cast<float>(params.decimate);
    for (const std::string& name : names) {
      families_.push_back(makeAprilTagFamily(name));
      checkTable(name, *families_.back(), params.max_hamming);
      apriltag_detector_add_family_bits(detector_.get(), families_.back().get(), params.max_hamming);
    }
  }

  std::vector<Detection> detect(const cv::Mat& image, const CameraModel* camera) override {
    const double min_side = 16 * params_.decimate;  // libapriltag divides by the number of its 4-pixel tiles
    if (image.cols < min_side || image.rows < min_side) return {};
    image_u8_t view{image.cols, image.rows, static_cast<int>(image.step), image.data};
    zarray_t* found = apriltag_detector_detect(detector_.get(), &view);
    std::vector<Detection> detections;
    for (int i = 0; i < zarray_size(found); ++i) {
      apriltag_detection_t* tag;
      zarray_get(found, i, &tag);
      if (tag->hamming <= params_.max_hamming && tag->decision_margin >= params_.min_decision_margin)
        detections.push_back(refined(image, camera, *tag));
    }
    apriltag_detections_destroy(found);
    return detections;
  }

 private:
  // libapriltag's corners begin at the bottom left and run counterclockwise; its pixel (0, 0) begins at that
  // pixel's edge.
  static Detection detection(const apriltag_detection_t& tag) {
    Detection found;
    found.key = {tag.family->name, tag.id};
    for (int i = 0; i < 4; ++i) found.corners[i] = {tag.p[3 - i][0] - 0.5, tag.p[3 - i][1] - 0.5};
    found.hamming = tag.hamming;
    found.decision_margin = tag.decision_margin;
    return found;
  }

  Detection refined(const cv::Mat& image, const CameraModel* camera, const apriltag_detection_t& tag) const {
    Detection found = detection(tag);
    if (!params_.refine_corners) return found;
    const BorderSquare square{tag.family->width_at_border, tag.family->reversed_border, kRawSigma};
    const RefinedCorners refined = refineCorners(image, found.corners, square, camera);
    found.corners = refined.corners;
    found.corner_sigmas = refined.sigmas;
    return found;
  }

  DetectorParams params_;
  std::vector<AprilTagFamily> families_;  // outlives the detector, which points to them
  std::unique_ptr<apriltag_detector_t, void (*)(apriltag_detector_t*)> detector_;
};

}  // namespace

std::unique_ptr<MarkerDetector> makeAprilTagDetector(const DetectorParams& params,
                                                     const std::vector<std::string>& families) {
  return std::make_unique<AprilTagDetector>(params, families);
}

}  // namespace sextant
