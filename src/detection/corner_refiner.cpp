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
#include "hidden_edge.hpp"
#include "module_grid.hpp"

namespace sextant {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSearchDeviations = 5;  // deviations of the start within which edges are looked for
constexpr double kLeastReach = 1.5;      // pixels
constexpr double kStartReach = 6;       // pixels, at least, as far as a module goes: a contour may lie inside
constexpr double kFarthestCorner = 3;   // such reaches that a corner may lie from its start
constexpr double kMinLength = 8;        // pixels of an edge
constexpr double kCurvedEdge = 60;      // pixels from which an edge is long enough to show a lens's curvature
constexpr double kSettledStep = 0.1;    // pixels; the next step would be a tenth of this one
constexpr double kFloor = 0.015;        // pixels: deviation of what the scatter does not show
constexpr double kCutScatter = 0.97;    // share of a normal variance that the fit's outlier limit leaves
constexpr double kNeighbours = 0.3;     // blurs that the next module's step pulls an edge where it touches it
constexpr double kLeastBlur = 0.8;      // pixels; a sharper image errs as much by its coarse sampling
constexpr double kMaxSimilarity = 0.8;  // of neighbouring residuals
constexpr double kBlurred = 0.5;        // sharpness below which a wider reach tells more
constexpr double kMaxBitOffset = 0.35;  // pixels between one side and the others
constexpr double kMaxBitShift = 0.12;   // modules; what a wide lens does to the grid's is less
constexpr double kClearModule = 2;      // pixels from which bits are seen apart
constexpr double kCommon = 0.15;        // pixels by which lens and print move what is seen of a square
constexpr double kHiddenDoubt = 0.5;    // modules that the start's edge may be off where no edge was found

double moduleAcross(const Corners& corners, int side, int modules) {
  const Eigen::Vector2d along = (corners[(side + 1) % 4] - corners[side]).normalized();
  const Eigen::Vector2d across =
      0.5 * (corners[(side + 2) % 4] + corners[(side + 3) % 4] - corners[side] - corners[(side + 1) % 4]);
  return std::abs(along.x() * across.y() - along.y() * across.x()) / modules;
}

struct Edge {
  Eigen::Vector2d begin, end;
  double module;  // pixels across
  double reach;   // pixels
  double bend = 0;
  bool found = true;
  std::optional<EdgeFit> fit;
  double doubt = 0;  // pixels that it may be off beside its scatter
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

  // Pixels from a point to the image's border along an edge's normal.
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

  // Takes every edge to its corners, and returns how far the farthest of these has moved.
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

  // Print and exposure can widen all black or all white alike: an edge is off that is off against the others.
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
    const bool off = least > std::max(kMaxBitOffset, kMaxBitShift * edges_[i].module);
    return least < kInfinity && off ? least : 0;
  }

  std::optional<double> bitOffset(const Corners& corners, int side) const {
    const Edge &near = edges_[side], &far = edges_[(side + 2) % 4];
    if (!near.found || near.module < kClearModule) return std::nullopt;
    const EdgeCurve across =
        far.found ? far.fit->curve : EdgeCurve(far.begin, far.end, !square_.white_inside);
    const ModuleGrid grid(corners, side, square_.modules, near.fit->curve, across);
    return grid.bitOffset(image_, near.fit->contrast);
  }

  // Variance of a sample of every found edge and what it is worth, by the scatter of all of them: one alone
  // has few.
  double scatter() const {
    double squares = 0, lagged = 0;
    int freedom = 0;
    for (const Edge& edge : edges_)
      if (edge.found) {
        squares += edge.fit->squares;
        lagged += edge.fit->lagged;
        freedom += edge.fit->freedom;
      }
    const double similar = std::clamp(lagged / std::max(squares, 1e-9), 0.0, kMaxSimilarity);
    return squares / freedom / kCutScatter * (1 + similar) / (1 - similar);
  }

  // What the blurred steps of neighbouring modules add to an edge's variance, measured over simulated drives
  // with blurs of 0.3 to 1.5 pixels and modules of 1.5 to 12.
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
        const double off = kHiddenDoubt * std::max(before.module, after.module);
        refined.sigmas[i] = std::hypot(square_.start_sigma, doubtful > 0 ? doubtful : off);
      }
    }
    return refined;
  }

  // The only edge that is hidden, unless it is that of tiny modules.
  std::optional<int> hidden() const {
    std::optional<int> only;
    for (int i = 0; i < 4; ++i) {
      if (edges_[i].found && edges_[i].doubt == 0) continue;
      if (only || edges_[i].module < kClearModule) return std::nullopt;
      only = i;
    }
    return only;
  }

  // With what three edges tell of the fourth, where that is more than the start.
  RefinedCorners completed() const {
    RefinedCorners refined = result();
    const auto i = hidden();
    if (!camera_ || !i) return refined;
    const Edge &before = edges_[(*i + 3) % 4], &after = edges_[(*i + 1) % 4];
    const double sample = scatter();
    const auto sigma = [&](const Edge& edge, double s) {
      return std::sqrt(kCommon * kCommon + edgeVariance(edge, s, sample));
    };
    CornerSigmas corner_sigmas = refined.sigmas;
    for (double& each : corner_sigmas) each = std::hypot(kCommon, each);
    const auto found = findHidden(
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

  static double doubt(const Edge& edge) { return edge.found ? edge.doubt : kHiddenDoubt * edge.module; }

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
