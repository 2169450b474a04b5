// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "occluded_edge.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "sextant/markers/marker_pose.hpp"

namespace sextant {
namespace {

constexpr int kMaxIterations = 40;
constexpr double kTilt = 0.5;  // radians; tilt of the additional starts about a parallel to the occluded edge
// converged if a step reduces the residual norm by less than this, standard deviations
constexpr double kSettledDeviations = 1e-3;
// maximum residual norm of a solution; seen head-on, noise may leave no exact one
constexpr double kSolved = 4;

// Residuals of the equations divided by their standard deviations, and their Jacobian with respect to the
// pose.
struct Equations {
  Vector6d residual;
  Matrix6d jacobian;
};

struct Point {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 6> jacobian;
};

std::optional<Point> projectCorner(const CameraModel& camera, const Pose& pose, int corner) {
  const Eigen::Vector3d arm = pose.linear() * markerCorners(1.0)[corner];
  const auto projection = camera.projectWithJacobian(arm + pose.translation());
  if (!projection) return std::nullopt;
  Point point{projection->pixel, {}};
  point.jacobian << projection->jacobian, -projection->jacobian * skew(arm);
  return point;
}

// Signed distance of a pixel from the curve.
double distance(const EdgeCurve& curve, const Eigen::Vector2d& pixel, Eigen::RowVector2d* gradient) {
  const Eigen::Vector2d p = pixel - curve.middle, along = curve.half / curve.half.squaredNorm();
  const double s = p.dot(along);
  *gradient = (curve.normal - curve.slope(s) * along).transpose();
  return p.dot(curve.normal) - curve.offset(s);
}

struct Solution {
  Pose pose;
  double residual;  // norm, standard deviations
};

class Solver {
 public:
  Solver(const CameraModel& camera, const Corners& corners, const OccludedEdge& edge)
      : camera_(camera), corners_(corners), edge_(edge) {}

  std::optional<Equations> equations(const Pose& pose) const {
    Equations all;
    for (int k = 0; k < 4; ++k) {
      const int i = (edge_.first_corner + k) % 4;
      const auto point = projectCorner(camera_, pose, i);
      if (!point) return std::nullopt;
      if (k < 2) {
        Eigen::RowVector2d gradient;
        const double off = distance(k == 0 ? edge_.before : edge_.after, point->pixel, &gradient);
        const double sigma = k == 0 ? edge_.before_sigma : edge_.after_sigma;
        all.residual[k] = off / sigma;
        all.jacobian.row(k) = gradient * point->jacobian / sigma;
      } else {
        all.residual.segment<2>(2 * k - 2) = (point->pixel - corners_[i]) / edge_.corner_sigmas[i];
        all.jacobian.middleRows<2>(2 * k - 2) = point->jacobian / edge_.corner_sigmas[i];
      }
    }
    return all;
  }

  // Levenberg-Marquardt, because two of the six directions are weakly determined.
  std::optional<Solution> solve(Pose pose) const {
    auto now = equations(pose);
    if (!now) return std::nullopt;
    double damping = 1e-6;
    for (int i = 0; i < kMaxIterations; ++i) {
      Matrix6d H = now->jacobian.transpose() * now->jacobian;
      H.diagonal() *= 1 + damping;
      const Pose next = perturbed(pose, -H.ldlt().solve(now->jacobian.transpose() * now->residual));
      const auto then = equations(next);
      const double gain = then ? now->residual.norm() - then->residual.norm() : -1;
      damping *= gain > 0 ? 0.1 : 100;
      if (gain > 0) pose = next, now = then;
      if (gain >= 0 && gain < kSettledDeviations) break;
    }
    return Solution{pose, now->residual.norm()};
  }

  std::optional<ReconstructedEdge> edgeAt(const Pose& pose) const {
    const auto at = equations(pose);
    const Eigen::LLT<Matrix6d> information(at->jacobian.transpose() * at->jacobian);
    if (information.info() != Eigen::Success) return std::nullopt;
    // Columns of a square root of the covariance.
    const Matrix6d root = information.matrixU().solve(Matrix6d::Identity());
    ReconstructedEdge edge;
    for (int k = 0; k < 2; ++k) {
      const int i = (edge_.first_corner + k) % 4;
      edge.corners[k] = projectCorner(camera_, pose, i)->pixel;
      double squares = 0;
      for (int j = 0; j < 12; ++j) {
        const Vector6d step = std::sqrt(6.0) * (j < 6 ? 1 : -1) * root.col(j % 6);
        const auto point = projectCorner(camera_, perturbed(pose, step), i);
        if (!point) return std::nullopt;
        squares += (point->pixel - edge.corners[k]).squaredNorm() / 12;
      }
      edge.sigmas[k] = std::sqrt(squares / 2);
    }
    return edge;
  }

 private:
  const CameraModel& camera_;
  const Corners& corners_;
  const OccludedEdge& edge_;
};

// Inflates the standard deviations so that they cover the corners of all solutions.
void widen(const CameraModel& camera, const std::vector<Solution>& solutions, int first_corner,
           ReconstructedEdge& edge) {
  for (int k = 0; k < 2; ++k) {
    double farthest = 0;
    for (const Solution& other : solutions)
      farthest = std::max(
          farthest,
          (projectCorner(camera, other.pose, (first_corner + k) % 4)->pixel - edge.corners[k]).squaredNorm() /
              2);
    edge.sigmas[k] = std::sqrt(edge.sigmas[k] * edge.sigmas[k] + farthest);
  }
}

}  // namespace

std::optional<ReconstructedEdge> reconstructEdge(const CameraModel& camera, const Corners& corners,
                                                 const OccludedEdge& edge) {
  const auto start = solveMarkerPose(camera, corners, 1.0);
  if (!start) return std::nullopt;
  std::vector<Pose> starts = {start->best.T_camera_marker};
  if (start->alternative) starts.push_back(start->alternative->T_camera_marker);
  // The initial pose depends on the occluded corners, so start from several tilts.
  const Eigen::Vector3d along =
      markerCorners(1.0)[(edge.first_corner + 1) % 4] - markerCorners(1.0)[edge.first_corner];
  for (const double tilt : {kTilt, -kTilt}) starts.emplace_back(starts[0] * Eigen::AngleAxisd(tilt, along));
  const Solver solver(camera, corners, edge);
  std::vector<Solution> solutions;
  for (const Pose& pose : starts)
    if (const auto solution = solver.solve(pose); solution && solution->residual < kSolved)
      solutions.push_back(*solution);
  if (solutions.empty()) return std::nullopt;
  const auto best = std::min_element(solutions.begin(), solutions.end(),
                                     [](auto& a, auto& b) { return a.residual < b.residual; });
  auto found = solver.edgeAt(best->pose);
  if (found) widen(camera, solutions, edge.first_corner, *found);
  return found;
}

}  // namespace sextant
