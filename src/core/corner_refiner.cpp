// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/core/corner_refiner.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace sextant {
namespace {

constexpr int kRounds = 3;
constexpr int kMaxProfile = 16;        // samples of a profile
constexpr double kStep = 0.5;          // pixels between the samples of a profile
constexpr double kReach = 0.9;         // modules, to either side of an edge
constexpr double kMinReach = 1.5;      // pixels
constexpr double kMinContrast = 12.0;  // grey levels between the border's black and the white around it
constexpr double kCurvedEdge = 60.0;   // pixels from which an edge is long enough to show a lens's curvature
constexpr double kMaxShift = 2.5;      // pixels that a corner may move from its start

// An edge as offset(s) = a + b s + c s^2 along the normal, s from -1 (begin) to 1 (end) along the chord.
struct Edge {
  Eigen::Vector2d middle, half, normal;
  Eigen::Vector3d coefficients = Eigen::Vector3d::Zero();

  Eigen::Vector2d at(double s) const {
    return middle + s * half + normal * (coefficients[0] + s * (coefficients[1] + s * coefficients[2]));
  }
  Eigen::Vector2d tangent(double s) const {
    return half + normal * (coefficients[1] + 2 * s * coefficients[2]);
  }
};

double grey(const cv::Mat& image, const Eigen::Vector2d& p) {
  const int x = static_cast<int>(p.x()), y = static_cast<int>(p.y());
  const double u = p.x() - x, v = p.y() - y;
  const uchar* row = image.ptr<uchar>(y) + x;
  const uchar* next = row + image.step;
  return (1 - v) * ((1 - u) * row[0] + u * row[1]) + v * ((1 - u) * next[0] + u * next[1]);
}

bool inside(const cv::Mat& image, const Eigen::Vector2d& p) {
  return p.x() >= 0 && p.y() >= 0 && p.x() < image.cols - 1 && p.y() < image.rows - 1;
}

// Offset along the normal (which points from black to white) of the edge at p: centroid of the gradient
// over the rising slope around the steepest place, so that neither the bits inside nor what lies beyond the
// white counts.
std::optional<double> edgeOffset(const cv::Mat& image, const Eigen::Vector2d& p,
                                 const Eigen::Vector2d& normal, double reach) {
  std::array<double, kMaxProfile> rise;
  const int n = std::min(kMaxProfile, 2 * static_cast<int>(std::lround(reach / kStep)));
  const double begin = -0.5 * n * kStep;
  if (!inside(image, p + begin * normal) || !inside(image, p - begin * normal)) return std::nullopt;
  double previous = grey(image, p + begin * normal);
  for (int i = 0; i < n; ++i) {
    const double value = grey(image, p + (begin + (i + 1) * kStep) * normal);
    rise[i] = value - previous;
    previous = value;
  }
  const int steepest = static_cast<int>(std::max_element(rise.begin(), rise.begin() + n) - rise.begin());
  int first = steepest, last = steepest;
  while (first > 0 && rise[first - 1] > 0) --first;
  while (last < n - 1 && rise[last + 1] > 0) ++last;
  double weight = 0, moment = 0;
  for (int i = first; i <= last; ++i) {
    weight += rise[i];
    moment += rise[i] * (begin + (i + 0.5) * kStep);
  }
  return weight < kMinContrast ? std::nullopt : std::optional<double>(moment / weight);
}

struct Sample {
  double s, offset;
};

// Least squares, then once more without the samples that stand off by more than 2.5 robust deviations.
bool fit(Edge& edge, std::vector<Sample> samples, int terms) {
  for (int round = 0; round < 2; ++round) {
    if (samples.size() < static_cast<size_t>(terms) + 2) return false;
    Eigen::MatrixXd A(samples.size(), terms);
    Eigen::VectorXd b(samples.size());
    for (size_t i = 0; i < samples.size(); ++i) {
      for (int k = 0; k < terms; ++k) A(i, k) = std::pow(samples[i].s, k);
      b[i] = samples[i].offset;
    }
    edge.coefficients.setZero();
    edge.coefficients.head(terms) = A.colPivHouseholderQr().solve(b);
    Eigen::ArrayXd residuals = (A * edge.coefficients.head(terms) - b).array().abs();
    std::vector<double> sorted(residuals.data(), residuals.data() + residuals.size());
    std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
    const double limit = 2.5 * std::max(1.48 * sorted[sorted.size() / 2], 0.05);
    std::vector<Sample> kept;
    for (size_t i = 0; i < samples.size(); ++i)
      if (residuals[i] <= limit) kept.push_back(samples[i]);
    samples = kept;
  }
  return true;
}

std::optional<Edge> findEdge(const cv::Mat& image, const Eigen::Vector2d& begin, const Eigen::Vector2d& end,
                             double reach, bool white_inside) {
  Edge edge{0.5 * (begin + end), 0.5 * (end - begin), {}};
  const double length = 2 * edge.half.norm();
  if (length < 6) return std::nullopt;
  const Eigen::Vector2d outward =
      Eigen::Vector2d(edge.half.y(), -edge.half.x()).normalized();  // clockwise corners
  edge.normal = white_inside ? -outward : outward;
  const double margin =
      std::min(0.8, (reach + 0.5) / (0.5 * length));  // the corners' blur belongs to two edges
  const int count = std::clamp(static_cast<int>(length), 8, 100);
  std::vector<Sample> samples;
  for (int i = 0; i < count; ++i) {
    const double s = (1 - margin) * (2.0 * i / (count - 1) - 1);
    if (const auto offset = edgeOffset(image, edge.middle + s * edge.half, edge.normal, reach))
      samples.push_back({s, *offset});
  }
  if (2 * samples.size() < static_cast<size_t>(count)) return std::nullopt;
  if (!fit(edge, samples, length > kCurvedEdge ? 3 : 2)) return std::nullopt;
  return edge;
}

// Where edge a ends and edge b begins, by Newton's method on a(s) = b(t).
std::optional<Eigen::Vector2d> intersect(const Edge& a, const Edge& b) {
  double s = 1, t = -1;
  for (int i = 0; i < 5; ++i) {
    Eigen::Matrix2d J;
    J << a.tangent(s), -b.tangent(t);
    const Eigen::Vector2d step = J.inverse() * (b.at(t) - a.at(s));
    s += step[0];
    t += step[1];
    if (!(std::abs(s) < 3) || !(std::abs(t) < 3)) return std::nullopt;
  }
  return a.at(s);
}

// The black border is one module wide, and so at least is the white around it: an edge may be searched that
// far.
double moduleAcross(const Corners& corners, int side, int modules) {
  const Eigen::Vector2d along = (corners[(side + 1) % 4] - corners[side]).normalized();
  const Eigen::Vector2d across =
      0.5 * (corners[(side + 2) % 4] + corners[(side + 3) % 4] - corners[side] - corners[(side + 1) % 4]);
  return std::abs(along.x() * across.y() - along.y() * across.x()) / modules;
}

std::optional<Corners> refineOnce(const cv::Mat& image, const Corners& corners, const BorderSquare& square,
                                  double longest_reach) {
  std::array<Edge, 4> edges;
  for (int i = 0; i < 4; ++i) {
    const double reach =
        std::clamp(kReach * moduleAcross(corners, i, square.modules), kMinReach, longest_reach);
    const auto edge = findEdge(image, corners[i], corners[(i + 1) % 4], reach, square.white_inside);
    if (!edge) return std::nullopt;
    edges[i] = *edge;
  }
  Corners refined;
  for (int i = 0; i < 4; ++i) {
    const auto corner = intersect(edges[(i + 3) % 4], edges[i]);
    if (!corner) return std::nullopt;
    refined[i] = *corner;
  }
  return refined;
}

}  // namespace

std::optional<Corners> refineCorners(const cv::Mat& image, const Corners& corners,
                                     const BorderSquare& square) {
  Corners refined = corners;
  for (int round = 0; round < kRounds; ++round) {
    // The first search must cover the start's error, the later ones only the blur.
    const auto next = refineOnce(image, refined, square, round == 0 ? 3.0 : 2.5);
    if (!next) return std::nullopt;
    refined = *next;
  }
  for (int i = 0; i < 4; ++i)
    if (!((refined[i] - corners[i]).norm() < kMaxShift)) return std::nullopt;
  return refined;
}

}  // namespace sextant
