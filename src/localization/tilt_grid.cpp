// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tilt_grid.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

namespace sextant {
namespace {

using Vector4d = Eigen::Vector4d;
using Matrix4d = Eigen::Matrix4d;
using Matrix64d = Eigen::Matrix<double, 6, 4>;

// Cost above the minimum at which the grid ends: a Gaussian has 5e-5 of its probability beyond it. A minimum
// that is more than kDepth - kBarrier above the least one may become a hypothesis of its own.
constexpr double kDepth = 20.0;
// Distance of the cells, standard deviations; up to 1, a sum over a Gaussian is exact to 1e-6.
constexpr double kSpacing = 1.0;
constexpr double kMaxSpacing = 0.1;  // maximum distance of the cells, radians
constexpr size_t kMaxCells = 1800;   // cells after which the grid is not grown any more
constexpr double kBarrier = 12.0;    // cost of a saddle above the higher of two separate minima

using CellIndex = std::pair<int, int>;  // along the two least certain axes, from the first minimum

// A cell to be computed.
struct QueuedCell {
  CellIndex index;
  Pose start;         // of the minimization, with the cell's tilt
  size_t hypothesis;  // index of the minimum from which it was reached
};

// Grows the grid by flood fill.
class GridGrowth {
 public:
  GridGrowth(const std::vector<MarkerObservation>& observations, const std::vector<PoseHypothesis>& minima,
             const std::optional<FloorPrior>& floor)
      : observations_(observations),
        minima_count_(minima.size()),
        pivot_(observations),
        origin_(minima[0].T_map_base) {
    params_.floor = floor;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> rotation(
        minima[0].covariance.bottomRightCorner<3, 3>());
    axes_ << rotation.eigenvectors().col(2), rotation.eigenvectors().col(1),
        rotation.eigenvectors().col(2).cross(rotation.eigenvectors().col(1));
    const Eigen::Vector2d deviations(rotation.eigenvalues()[2], rotation.eigenvalues()[1]);
    spacing_ = (kSpacing * deviations.cwiseMax(0).cwiseSqrt()).cwiseMin(kMaxSpacing).cwiseMax(1e-6);
    for (size_t k = 0; k < minima.size(); ++k) seed(minima[k].T_map_base, k);
  }

  TiltGrid grow() {
    for (size_t next = 0; next < queue_.size() && cells_.size() < kMaxCells; ++next) {
      const QueuedCell queued = queue_[next];
      const auto cell = minimized(queued);
      if (!cell) continue;
      visited_[queued.index] = static_cast<int>(cells_.size());
      cells_.push_back(*cell);
      for (const auto& [i, j] : {CellIndex{1, 0}, CellIndex{-1, 0}, CellIndex{0, 1}, CellIndex{0, -1}})
        enqueue({queued.index.first + i, queued.index.second + j}, tilt(queued.index), cell->T_map_base,
                queued.hypothesis);
    }
    auto groups = connectedMinima();
    return {std::move(cells_), std::move(groups)};
  }

 private:
  // Rotation of a cell from the first minimum.
  Eigen::Matrix3d tilt(const CellIndex& index) const {
    return expSO3(axes_.leftCols<2>() * spacing_.cwiseProduct(Eigen::Vector2d(index.first, index.second)));
  }

  // Enqueues the cell of a minimum, whose rotation from the first minimum is a tilt after a twist about the
  // third axis.
  void seed(const Pose& pose, size_t hypothesis) {
    Eigen::Quaterniond q(
        Eigen::Matrix3d(axes_.transpose() * pose.linear() * origin_.linear().transpose() * axes_));
    const Eigen::Quaterniond twist = Eigen::Quaterniond(q.w(), 0, 0, q.z()).normalized();
    const Eigen::Vector3d t = logSO3((q * twist.conjugate()).toRotationMatrix());
    const CellIndex index{static_cast<int>(std::lround(t.x() / spacing_.x())),
                          static_cast<int>(std::lround(t.y() / spacing_.y()))};
    enqueue(index, expSO3(axes_ * Eigen::Vector3d(t.x(), t.y(), 0)), pose, hypothesis);
  }

  // Enqueues a new cell, to start from a pose with another tilt.
  void enqueue(const CellIndex& index, const Eigen::Matrix3d& tilt_of_pose, const Pose& pose,
               size_t hypothesis) {
    if (!visited_.insert({index, kEmpty}).second) return;
    Vector6d step = Vector6d::Zero();
    step.tail<3>() = logSO3(tilt(index) * tilt_of_pose.transpose());
    queue_.push_back({index, pivot_.moved(pose, step), hypothesis});
  }

  // Minimizes over translation and twist (Gauss-Newton); nothing if the cost is too high.
  std::optional<TiltCell> minimized(const QueuedCell& queued) {
    const Eigen::Vector3d axis = tilt(queued.index) * axes_.col(2);
    Pose pose = queued.start;
    for (int round = 0; round < kRounds; ++round) {
      const ReprojectionModel model = reprojectionModel(observations_, pose, params_);
      Matrix64d basis = Matrix64d::Zero();
      basis.topLeftCorner<3, 3>().setIdentity();
      basis.col(3) << 0, 0, 0, axis;
      const Matrix64d G = pivot_.jacobian(pose) * basis;
      const Eigen::LLT<Matrix4d> cholesky(G.transpose() * model.H * G);
      if (cholesky.info() != Eigen::Success) return std::nullopt;
      const Vector4d gradient = G.transpose() * model.g, step = -cholesky.solve(gradient);
      const double cost = model.cost + gradient.dot(step);
      pose = pivot_.moved(pose, basis * step);
      if (round + 1 < kRounds) continue;
      if (!(cost - least_cost_ < kDepth)) return std::nullopt;
      least_cost_ = std::min(least_cost_, cost);
      const Matrix64d root = cholesky.matrixU().solve<Eigen::OnTheRight>(G);
      const double log_determinant = 2 * cholesky.matrixLLT().diagonal().array().log().sum();
      return TiltCell{pose, root * root.transpose(), -0.5 * (cost + log_determinant), cost,
                      queued.hypothesis};
    }
    return std::nullopt;
  }

  // Groups minima that are connected without a barrier between them.
  std::vector<size_t> connectedMinima() const {
    std::vector<double> least(minima_count_, std::numeric_limits<double>::infinity());
    for (const TiltCell& cell : cells_) least[cell.hypothesis] = std::min(least[cell.hypothesis], cell.cost);
    std::vector<size_t> group(minima_count_);
    std::iota(group.begin(), group.end(), size_t{0});
    for (const auto& entry : visited_) {
      const auto& [i, j] = entry.first;
      for (const CellIndex& neighbour : {CellIndex{i + 1, j}, CellIndex{i, j + 1}}) {
        const TiltCell *a = cellAt(entry.first), *b = cellAt(neighbour);
        if (!a || !b || group[a->hypothesis] == group[b->hypothesis]) continue;
        if (std::max(a->cost, b->cost) - std::max(least[a->hypothesis], least[b->hypothesis]) < kBarrier)
          std::replace(group.begin(), group.end(), size_t{group[b->hypothesis]},
                       size_t{group[a->hypothesis]});
      }
    }
    return group;
  }

  const TiltCell* cellAt(const CellIndex& index) const {
    const auto found = visited_.find(index);
    return found == visited_.end() || found->second == kEmpty ? nullptr : &cells_[found->second];
  }

  static constexpr int kRounds = 2;  // Gauss-Newton steps
  static constexpr int kEmpty = -1;  // index of cells that are not in cells_
  const std::vector<MarkerObservation>& observations_;
  size_t minima_count_;
  ReprojectionParams params_;
  Pivot pivot_;
  Pose origin_;              // the first minimum
  Eigen::Matrix3d axes_;     // columns: axes of the two least certain rotations, and the third
  Eigen::Vector2d spacing_;  // radians
  double least_cost_ = std::numeric_limits<double>::infinity();
  std::map<CellIndex, int> visited_;  // index in cells_, or kEmpty
  std::vector<QueuedCell> queue_;
  std::vector<TiltCell> cells_;
};

}  // namespace

TiltGrid tiltGrid(const std::vector<MarkerObservation>& observations,
                  const std::vector<PoseHypothesis>& minima, const std::optional<FloorPrior>& floor) {
  return GridGrowth(observations, minima, floor).grow();
}

}  // namespace sextant
