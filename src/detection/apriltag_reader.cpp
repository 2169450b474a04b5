// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apriltag_reader.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "sextant/markers/marker_family.hpp"

namespace sextant {
namespace {

constexpr double kSharpening = 0.25;       // libapriltag's default
constexpr double kMaxBook = 1e6;           // numbers; families with larger books have none
constexpr double kMinLight = 5;            // grey levels between black and white, as in libapriltag
constexpr double kMinBlurredBorder = 0.8;  // see TagReading::border

// Grey levels at positions on a tag, in modules from its top left corner.
class TagSampler {
 public:
  TagSampler(const cv::Mat& image, const Corners& corners, int width) : image_(image) {
    const auto side = static_cast<float>(width);
    const cv::Point2f square[] = {{0, 0}, {side, 0}, {side, side}, {0, side}};
    cv::Point2f quad[4];
    for (int i = 0; i < 4; ++i)
      quad[i] = {static_cast<float>(corners[i].x()), static_cast<float>(corners[i].y())};
    H_ = cv::getPerspectiveTransform(square, quad);
  }

  // Interpolates between pixels; nothing outside of the image.
  std::optional<double> operator()(double u, double v) const {
    const cv::Vec3d p = H_ * cv::Vec3d(u, v, 1);
    const double x = p[0] / p[2], y = p[1] / p[2];
    if (!(x >= 0 && y >= 0 && x <= image_.cols - 1 && y <= image_.rows - 1)) return std::nullopt;
    const int left = std::min(static_cast<int>(x), image_.cols - 2);
    const int top = std::min(static_cast<int>(y), image_.rows - 2);
    const double right_share = x - left, low_share = y - top;
    const uchar *upper = image_.ptr(top) + left, *lower = image_.ptr(top + 1) + left;
    return (1 - low_share) * ((1 - right_share) * upper[0] + right_share * upper[1]) +
           low_share * ((1 - right_share) * lower[0] + right_share * lower[1]);
  }

 private:
  const cv::Mat& image_;
  cv::Matx33d H_;
};

// Least squares plane through grey levels.
class LightPlane {
 public:
  void add(double u, double v, double grey) {
    const Eigen::Vector3d row(u, v, 1);
    normal_ += row * row.transpose();
    right_ += grey * row;
    ++count_;
  }

  // Returns whether the samples determine a plane.
  bool fit() {
    const Eigen::FullPivLU<Eigen::Matrix3d> lu(normal_);
    if (count_ < 3 || !lu.isInvertible()) return false;
    plane_ = lu.solve(right_);
    return true;
  }

  double at(double u, double v) const { return plane_.dot(Eigen::Vector3d(u, v, 1)); }

 private:
  Eigen::Matrix3d normal_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_ = Eigen::Vector3d::Zero(), plane_ = Eigen::Vector3d::Zero();
  int count_ = 0;
};

// The modules along all four sides, on one side of the border's edge.
class Ring {
 public:
  Ring(const TagSampler& sample, int width, double inset) : sample_(sample) {
    for (int k = 0; k < width; ++k)
      for (const double across : {inset, width - inset}) {
        add(across, k + 0.5);
        add(k + 0.5, across);
      }
  }

  LightPlane light() const {
    LightPlane light;
    for (const Module& module : modules_) light.add(module.u, module.v, module.grey);
    return light;
  }

  // Number of modules that are lighter (sign 1) or darker (-1) than the threshold.
  template <typename Threshold>
  double count(const Threshold& threshold, int sign) const {
    return std::count_if(modules_.begin(), modules_.end(), [&](const Module& module) {
      return sign * (module.grey - threshold(module.u, module.v)) > 0;
    });
  }
  double size() const { return static_cast<double>(modules_.size()); }

 private:
  struct Module {
    double u, v, grey;
  };
  void add(double u, double v) {
    if (const auto grey = sample_(u, v)) modules_.push_back({u, v, *grey});
  }
  const TagSampler& sample_;
  std::vector<Module> modules_;
};

// Mean distance from the threshold by colour.
struct Scores {
  double sum[2] = {0, 0};
  int count[2] = {0, 0};

  void add(double value) {
    const int white = value > 0 ? 1 : 0;
    sum[white] += std::abs(value);
    ++count[white];
  }
  double smaller() const { return std::min(sum[0] / std::max(1, count[0]), sum[1] / std::max(1, count[1])); }
};

}  // namespace

AprilTagReader::AprilTagReader(const apriltag_family_t& family)
    : family_(family), stride_(family.total_width + 2) {
  const int outside = (family.total_width - family.width_at_border) / 2;
  for (size_t i = 0; i < family.nbits; ++i) {
    const int x = static_cast<int>(family.bit_x[i]) + outside + 1;
    const int y = static_cast<int>(family.bit_y[i]) + outside + 1;
    cells_.push_back(static_cast<size_t>(y * stride_ + x));
  }
  if (family.ncodes <= kMaxBook) makeBook();
}

void AprilTagReader::makeBook() {
  const int outside = (family_.total_width - family_.width_at_border) / 2, width = family_.total_width + 2;
  Eigen::MatrixXf prints(family_.ncodes, width * width);
  std::vector<cv::Point> places;
  for (size_t i = 0; i < family_.nbits; ++i)
    places.emplace_back(static_cast<int>(family_.bit_x[i]) + outside + 1,
                        static_cast<int>(family_.bit_y[i]) + outside + 1);
  for (int id = 0; id < static_cast<int>(family_.ncodes); ++id) {
    cv::Mat print;
    const cv::Mat modules = markerImage(family_.name, id).modules;
    const int ring = (width - modules.cols) / 2;
    cv::copyMakeBorder(modules, print, ring, ring, ring, ring, cv::BORDER_CONSTANT, 255);
    for (int i = 0; i < width * width; ++i)
      prints(id, i) = print.at<uchar>(i / width, i % width) > 0 ? 1.0F : 0;
  }
  book_ = std::make_unique<CodeBook>(prints, width, places);
}

// Grey levels of the bits, from the threshold on, and how clear the border is around them.
struct AprilTagReader::Bits {
  Eigen::VectorXf greys;
  double contrast, border;
};

std::optional<AprilTagReader::Bits> AprilTagReader::bits(const cv::Mat& image, const Corners& corners) const {
  const int width = family_.width_at_border;
  const TagSampler sample(image, corners, width);
  const double inside = family_.reversed_border ? -0.5 : 0.5;
  const Ring white_ring(sample, width, -inside), black_ring(sample, width, inside);
  LightPlane white = white_ring.light(), black = black_ring.light();
  if (!white.fit() || !black.fit()) return std::nullopt;
  const double contrast = white.at(0.5 * width, 0.5 * width) - black.at(0.5 * width, 0.5 * width);
  if (contrast < kMinLight) return std::nullopt;
  const auto threshold = [&](double u, double v) { return 0.5 * (white.at(u, v) + black.at(u, v)); };
  const double right = white_ring.count(threshold, 1) + black_ring.count(threshold, -1);
  Bits bits{Eigen::VectorXf::Zero(family_.nbits), contrast, right / (white_ring.size() + black_ring.size())};
  for (Eigen::Index i = 0; i < bits.greys.size(); ++i) {
    const double u = static_cast<int>(family_.bit_x[i]) + 0.5, v = static_cast<int>(family_.bit_y[i]) + 0.5;
    if (const auto grey = sample(u, v)) bits.greys[i] = static_cast<float>(*grey - threshold(u, v));
  }
  return bits;
}

std::optional<TagReading> AprilTagReader::read(const cv::Mat& image, int id, const Corners& corners) const {
  const auto seen = bits(image, corners);
  if (!seen) return std::nullopt;
  std::vector<double> grid(static_cast<size_t>(stride_ * stride_), 0.0);
  for (size_t i = 0; i < cells_.size(); ++i) grid[cells_[i]] = seen->greys[static_cast<Eigen::Index>(i)];
  TagReading reading{0, 0, seen->contrast, seen->border, 0};
  Scores scores, unsharpened;
  for (size_t i = 0; i < cells_.size(); ++i) {
    const double value = sharpened(grid, cells_[i]);
    scores.add(value);
    unsharpened.add(grid[cells_[i]]);
    if ((value > 0) != bit(id, i)) ++reading.hamming;
  }
  reading.margin = scores.smaller();
  reading.clarity = unsharpened.smaller() / (0.5 * reading.contrast);
  return reading;
}

std::optional<CodeMatch> AprilTagReader::identify(const cv::Mat& image, const Corners& corners) const {
  if (!book_) return std::nullopt;
  const auto seen = bits(image, corners);
  if (!seen || seen->border < kMinBlurredBorder) return std::nullopt;
  return book_->match(seen->greys);
}

double AprilTagReader::border(const cv::Mat& image, const Corners& corners) const {
  const auto seen = bits(image, corners);
  return seen ? seen->border : 0;
}

bool AprilTagReader::resembles(const cv::Mat& image, int id, const Corners& corners) const {
  if (!book_) return false;
  const auto seen = bits(image, corners);
  return seen && seen->border >= kMinBlurredBorder && book_->resembles(seen->greys, id);
}

double AprilTagReader::sharpened(const std::vector<double>& grid, size_t cell) const {
  const auto row = static_cast<size_t>(stride_);
  const double around = grid[cell - 1] + grid[cell + 1] + grid[cell - row] + grid[cell + row];
  return grid[cell] + kSharpening * (4 * grid[cell] - around);
}

}  // namespace sextant
