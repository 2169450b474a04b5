// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/detection/corner_refiner.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "edge_fit.hpp"
#include "module_grid.hpp"
#include "occluded_edge.hpp"

namespace sextant {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSearchDeviations =
    5;                                 // standard deviations of the initial corners; limit of the first reach
constexpr double kLeastReach = 1.5;    // pixels; minimum reach
constexpr double kStartReach = 6;      // pixels; minimum of this limit, as a contour may lie inside the edge
constexpr double kFarthestCorner = 3;  // maximum distance of a corner from its start, in reaches
constexpr double kMinLength = 8;       // minimum length of an edge, pixels
constexpr double kCurvedEdge = 60;     // pixels; minimum length of an edge that shows lens curvature
constexpr double kSettledStep = 0.1;   // pixels; the next step would be a tenth of the last one
constexpr double kFloor = 0.015;       // pixels; standard deviation that residuals do not show
constexpr double kCutScatter = 0.97;   // fraction of a Gaussian's variance within the fit's outlier limit
constexpr double kNeighbours = 0.3;    // shift of an edge by the step of an adjacent module, in blurs
constexpr double kLeastBlur = 0.8;     // pixels; in sharper images coarse sampling has the same effect
constexpr double kMaxCorrelation = 0.8;  // maximum correlation of neighbouring residuals
constexpr double kBlurred = 0.5;         // sharpness below which a wider reach is better
constexpr double kMaxBitOffset = 0.35;   // pixels; maximum difference between one side and the others
constexpr double kMaxBitShift = 0.12;    // modules, likewise; more than the distortion of a wide lens
constexpr double kClearModule = 2;       // pixels; minimum size of modules that can be separated
constexpr double kCommon = 0.15;         // pixels; standard deviation of systematic errors of lens and marker
constexpr double kOccludedDoubt = 0.5;   // modules; standard deviation of an initial edge that was not found

// Width of a module perpendicular to a side, pixels.
double moduleAcross(const Corners& corners, int side, int modules) {
  const Eigen::Vector2d along = (corners[(side + 1) % 4] - corners[side]).normalized();
  const Eigen::Vector2d across =
      0.5 * (corners[(side + 2) % 4] + corners[(side + 3) % 4] - corners[side] - corners[(side + 1) % 4]);
  return std::abs(along.x() * across.y() - along.y() * across.x()) / modules;
}

struct Edge {
  Eigen::Vector2d begin, end;
  double module;    // width of a module across the edge, pixels
  double reach;     // search distance to either side, pixels
  double bend = 0;  // c[2] of the parabola, pixels
  bool found = true;
  std::optional<EdgeFit> fit;
  double doubt = 0;  // pixels; standard deviation that its residuals do not show
};

class SquareFit {
 public:
  SquareFit(const cv::Mat& image, const Corners& start, const BorderSquare& square, const CameraModel* camera)
      : image_(image), start_(start), square_(square), camera_(camera) {
    for (int i = 0; i < 4; ++i) {
      Edge& edge = edges_[i];
      edge.begin = start[i];
      edge.end = start[(i + 1) % 4];
      edge.module = moduleAcross(start, i, square.modules);
      edge.reach = std::clamp(edge.module - 1, kLeastReach, 4.0);
      edge.found = (edge.end - edge.begin).norm() >= kMinLength;
    }
  }

  RefinedCorners refine() {
    for (Edge& edge : edges_) search(edge);
    meet();
    for (const int samples : {24, 100, 100}) {
      for (Edge& edge : edges_) fit(edge, samples);
      if (meet() < kSettledStep && samples == 100) break;
    }
    const RefinedCorners refined = completed();
    return compareWithBits(refined.corners) ? refined : completed();
  }

 private:
  // The curve from which an edge is fitted. terms: number of coefficients to fit
  EdgeCurve curve(const Edge& edge, int* terms) const {
    EdgeCurve curve(edge.begin, edge.end, !square_.white_inside);
    *terms = 2;
    if (camera_ && curve.followLens(*camera_)) return curve;
    if (curve.length() > kCurvedEdge) *terms = 3;
    curve.bend(edge.bend);
    return curve;
  }

  double startReach(const Edge& edge) const {
    return std::clamp(0.9 * edge.module, kLeastReach,
                      std::max(kStartReach, kSearchDeviations * square_.start_sigma));
  }

  void search(Edge& edge) {
    if (!edge.found) return;
    int terms;
    const auto found = searchEdge(image_, curve(edge, &terms), {startReach(edge), 12, 2});
    edge.found = found.has_value();
    if (found) edge.fit = EdgeFit(*found);
  }

  // Distance from a point to the image border along an edge's normal, pixels.
  double room(const Eigen::Vector2d& point, const EdgeCurve& edge) const {
    const double x = std::min(point.x(), image_.cols - 1 - point.x());
    const double y = std::min(point.y(), image_.rows - 1 - point.y());
    return std::min(x / std::abs(edge.normal.x()), y / std::abs(edge.normal.y())) - 1;
  }

  void fit(Edge& edge, int samples) {
    if (!edge.found) return;
    int terms;
    const EdgeCurve start = curve(edge, &terms);
    const double reach = std::min({edge.reach, room(edge.begin, start), room(edge.end, start)});
    edge.fit = fitEdge(image_, start, {std::max(reach, kLeastReach), samples, terms});
    edge.found = edge.fit.has_value();
    if (!edge.found) return;
    edge.bend = terms == 3 ? edge.fit->curve.c[2] : 0;
    if (edge.fit->sharpness < kBlurred) edge.reach = std::clamp(edge.module - 1, edge.reach, 8.0);
  }

  std::optional<Eigen::Vector2d> corner(int i) const {
    const Edge &before = edges_[(i + 3) % 4], &after = edges_[i];
    if (!before.found || !after.found) return std::nullopt;
    const auto met = intersect(before.fit->curve, after.fit->curve);
    const double reach = std::max(startReach(before), startReach(after));
    return met && (*met - start_[i]).norm() < kFarthestCorner * reach ? met : std::nullopt;
  }

  // Extends every edge to its corners and returns the largest displacement of a corner, pixels.
  double meet() {
    double farthest = 0;
    for (int i = 0; i < 4; ++i) {
      Edge &before = edges_[(i + 3) % 4], &after = edges_[i];
      const auto met = corner(i);
      if (met) farthest = std::max(farthest, (*met - after.begin).norm());
      if (before.found) before.end = met ? *met : before.fit->curve.at(1);
      if (after.found) after.begin = met ? *met : after.fit->curve.at(-1);
    }
    return farthest;
  }

  // Sets the doubt of each edge; returns whether there is none. Printing and exposure may widen all black or
  // white areas alike: an edge is wrong if its offset from the bits differs from those of the others.
  bool compareWithBits(const Corners& corners) {
    std::array<std::optional<double>, 4> offsets;
    for (int i = 0; i < 4; ++i) offsets[i] = bitOffset(corners, i);
    for (int i = 0; i < 4; ++i) edges_[i].doubt = farFromOthers(offsets, i);
    return std::all_of(edges_.begin(), edges_.end(), [](const Edge& edge) { return edge.doubt == 0; });
  }

  double farFromOthers(const std::array<std::optional<double>, 4>& offsets, int i) const {
    double least = kInfinity;
    for (int k = 0; k < 4; ++k)
      if (k != i && offsets[k] && offsets[i]) least = std::min(least, std::abs(*offsets[i] - *offsets[k]));
    const bool differs = least > std::max(kMaxBitOffset, kMaxBitShift * edges_[i].module);
    return least < kInfinity && differs ? least : 0;
  }

  std::optional<double> bitOffset(const Corners& corners, int side) const {
    const Edge &near = edges_[side], &far = edges_[(side + 2) % 4];
    if (!near.found || near.module < kClearModule) return std::nullopt;
    const EdgeCurve across =
        far.found ? far.fit->curve : EdgeCurve(far.begin, far.end, !square_.white_inside);
    const ModuleGrid grid(corners, side, square_.modules, near.fit->curve, across);
    return grid.bitOffset(image_, near.fit->contrast);
  }

  // Variance of a sample, corrected for correlation, pooled over all edges because one edge has few samples.
  double scatter() const {
    double squared_residuals = 0, lagged_products = 0;
    int degrees_of_freedom = 0;
    for (const Edge& edge : edges_)
      if (edge.found) {
        squared_residuals += edge.fit->squared_residuals;
        lagged_products += edge.fit->lagged_products;
        degrees_of_freedom += edge.fit->degrees_of_freedom;
      }
    const double correlation =
        std::clamp(lagged_products / std::max(squared_residuals, 1e-9), 0.0, kMaxCorrelation);
    return squared_residuals / degrees_of_freedom / kCutScatter * (1 + correlation) / (1 - correlation);
  }

  // Variance of an edge from the blurred steps of adjacent modules, measured in simulated drives with blurs
  // of 0.3 to 1.5 pixels and modules of 1.5 to 12.
  static double neighbourVariance(const Edge& edge) {
    const double blur = std::max(kLeastBlur, edge.fit->blur);
    const double pull = kNeighbours * blur * std::exp(-0.5 * edge.module / blur);
    return pull * pull;
  }

  double edgeVariance(const Edge& edge, double s, double scatter) const {
    return scatter * edge.fit->leverage(s) + neighbourVariance(edge);
  }

  double cornerVariance(int i, double scatter) const {
    const Edge &before = edges_[(i + 3) % 4], &after = edges_[i];
    Eigen::Matrix2d N;
    N << before.fit->curve.normal.transpose(), after.fit->curve.normal.transpose();
    const Eigen::Matrix2d inverse = N.inverse();
    const double v = edgeVariance(before, 1, scatter), w = edgeVariance(after, -1, scatter);
    return 0.5 * (v * inverse.col(0).squaredNorm() + w * inverse.col(1).squaredNorm());
  }

  RefinedCorners result() const {
    RefinedCorners refined{start_, {}};
    const double sample = scatter();
    for (int i = 0; i < 4; ++i) {
      const Edge &before = edges_[(i + 3) % 4], &after = edges_[i];
      const auto met = corner(i);
      if (met && before.doubt == 0 && after.doubt == 0) {
        refined.corners[i] = *met;
        refined.sigmas[i] = std::sqrt(kFloor * kFloor + cornerVariance(i, sample));
      } else {
        const double doubtful = std::max(doubt(before), doubt(after));
        const double unknown = kOccludedDoubt * std::max(before.module, after.module);
        refined.sigmas[i] = std::hypot(square_.start_sigma, doubtful > 0 ? doubtful : unknown);
      }
    }
    return refined;
  }

  // Index of the occluded edge if there is exactly one, unless its modules are tiny.
  std::optional<int> occludedEdge() const {
    std::optional<int> only;
    for (int i = 0; i < 4; ++i) {
      if (edges_[i].found && edges_[i].doubt == 0) continue;
      if (only || edges_[i].module < kClearModule) return std::nullopt;
      only = i;
    }
    return only;
  }

  // Replaces the corners of an occluded edge by those that follow from the other three edges, where these are
  // more accurate.
  RefinedCorners completed() const {
    RefinedCorners refined = result();
    const auto i = occludedEdge();
    if (!camera_ || !i) return refined;
    const Edge &before = edges_[(*i + 3) % 4], &after = edges_[(*i + 1) % 4];
    const double sample = scatter();
    const auto sigma = [&](const Edge& edge, double s) {
      return std::sqrt(kCommon * kCommon + edgeVariance(edge, s, sample));
    };
    CornerSigmas corner_sigmas = refined.sigmas;
    for (double& each : corner_sigmas) each = std::hypot(kCommon, each);
    const auto found = reconstructEdge(
        *camera_, refined.corners,
        {*i, before.fit->curve, after.fit->curve, sigma(before, 1), sigma(after, -1), corner_sigmas});
    for (int k = 0; found && k < 2; ++k) {
      const int corner = (*i + k) % 4;
      if (!(found->sigmas[k] < refined.sigmas[corner])) continue;
      refined.corners[corner] = found->corners[k];
      refined.sigmas[corner] = found->sigmas[k];
    }
    return refined;
  }

  static double doubt(const Edge& edge) { return edge.found ? edge.doubt : kOccludedDoubt * edge.module; }

  const cv::Mat& image_;
  const Corners& start_;
  const BorderSquare& square_;
  const CameraModel* camera_;
  std::array<Edge, 4> edges_;
};

}  // namespace

RefinedCorners refineCorners(const cv::Mat& image, const Corners& corners, const BorderSquare& square,
                             const CameraModel* camera) {
  return SquareFit(image, corners, square, camera).refine();
}

}  // namespace sextant
