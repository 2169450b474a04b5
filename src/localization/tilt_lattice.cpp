// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tilt_lattice.hpp"

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

constexpr double kDepth = 30.0;      // cost above the least at which the lattice ends
constexpr double kSpacing = 0.8;     // deviations; sums over a Gaussian are exact to 1e-6 up to 1
constexpr double kMaxSpacing = 0.1;  // radians
constexpr size_t kMaxCells = 1800;
constexpr double kBridge = 12.0;  // a saddle this far above the higher of two minima parts them

using Place = std::pair<int, int>;

struct Grown {
  Place place;
  Pose pose;
  size_t hypothesis;
};

class Lattice {
 public:
  Lattice(const std::vector<MarkerSighting>& sightings, const std::vector<PoseHypothesis>& minima,
          const std::optional<FloorPrior>& floor)
      : sightings_(sightings), minima_(minima.size()), pivot_(sightings), origin_(minima[0].T_map_base) {
    params_.floor = floor;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> rotation(
        minima[0].covariance.bottomRightCorner<3, 3>());
    axes_ << rotation.eigenvectors().col(2), rotation.eigenvectors().col(1),
        rotation.eigenvectors().col(2).cross(rotation.eigenvectors().col(1));
    const Eigen::Vector2d deviations(rotation.eigenvalues()[2], rotation.eigenvalues()[1]);
    spacing_ = (kSpacing * deviations.cwiseMax(0).cwiseSqrt()).cwiseMin(kMaxSpacing).cwiseMax(1e-6);
    for (size_t k = 0; k < minima.size(); ++k) seed(minima[k].T_map_base, k);
  }

  TiltLattice grow() {
    for (size_t next = 0; next < queue_.size() && cells_.size() < kMaxCells; ++next) {
      const Grown grown = queue_[next];
      const auto cell = minimized(grown);
      if (!cell) continue;
      visited_[grown.place] = static_cast<int>(cells_.size());
      cells_.push_back(*cell);
      for (const auto& [i, j] : {Place{1, 0}, Place{-1, 0}, Place{0, 1}, Place{0, -1}})
        visit({grown.place.first + i, grown.place.second + j}, tilt(grown.place), cell->T_map_base,
              grown.hypothesis);
    }
    auto groups = connected();
    return {std::move(cells_), std::move(groups)};
  }

 private:
  Eigen::Matrix3d tilt(const Place& place) const {
    return expSO3(axes_.leftCols<2>() * spacing_.cwiseProduct(Eigen::Vector2d(place.first, place.second)));
  }

  // The rotation from the origin is a tilt after a twist about the third axis.
  void seed(const Pose& pose, size_t hypothesis) {
    Eigen::Quaterniond q(
        Eigen::Matrix3d(axes_.transpose() * pose.linear() * origin_.linear().transpose() * axes_));
    const Eigen::Quaterniond twist = Eigen::Quaterniond(q.w(), 0, 0, q.z()).normalized();
    const Eigen::Vector3d t = logSO3((q * twist.conjugate()).toRotationMatrix());
    const Place place{static_cast<int>(std::lround(t.x() / spacing_.x())),
                      static_cast<int>(std::lround(t.y() / spacing_.y()))};
    visit(place, expSO3(axes_ * Eigen::Vector3d(t.x(), t.y(), 0)), pose, hypothesis);
  }

  void visit(const Place& place, const Eigen::Matrix3d& from, const Pose& pose, size_t hypothesis) {
    if (!visited_.insert({place, kEmpty}).second) return;
    Vector6d turn = Vector6d::Zero();
    turn.tail<3>() = logSO3(tilt(place) * from.transpose());
    queue_.push_back({place, pivot_.moved(pose, turn), hypothesis});
  }

  // Gauss-Newton over shift and twist; nothing where the cost is too high.
  std::optional<TiltCell> minimized(const Grown& grown) {
    const Eigen::Vector3d axis = tilt(grown.place) * axes_.col(2);
    Pose pose = grown.pose;
    for (int round = 0; round < kRounds; ++round) {
      const ReprojectionModel model = reprojectionModel(sightings_, pose, params_);
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
      if (!(cost - least_ < kDepth)) return std::nullopt;
      least_ = std::min(least_, cost);
      const Matrix64d root = cholesky.matrixU().solve<Eigen::OnTheRight>(G);
      const double log_determinant = 2 * cholesky.matrixLLT().diagonal().array().log().sum();
      return TiltCell{pose, root * root.transpose(), -0.5 * (cost + log_determinant), cost, grown.hypothesis};
    }
    return std::nullopt;
  }

  // Minima between which no barrier stands are one group.
  std::vector<size_t> connected() const {
    std::vector<double> depth(minima_, std::numeric_limits<double>::infinity());
    for (const TiltCell& cell : cells_) depth[cell.hypothesis] = std::min(depth[cell.hypothesis], cell.cost);
    std::vector<size_t> group(minima_);
    std::iota(group.begin(), group.end(), size_t{0});
    for (const auto& [place, index] : visited_)
      for (const Place& next : {Place{place.first + 1, place.second}, Place{place.first, place.second + 1}}) {
        const TiltCell *a = cellAt(place), *b = cellAt(next);
        if (!a || !b || group[a->hypothesis] == group[b->hypothesis]) continue;
        if (std::max(a->cost, b->cost) - std::max(depth[a->hypothesis], depth[b->hypothesis]) < kBridge)
          std::replace(group.begin(), group.end(), size_t{group[b->hypothesis]},
                       size_t{group[a->hypothesis]});
      }
    return group;
  }

  const TiltCell* cellAt(const Place& place) const {
    const auto found = visited_.find(place);
    return found == visited_.end() || found->second == kEmpty ? nullptr : &cells_[found->second];
  }

  static constexpr int kRounds = 2;
  static constexpr int kEmpty = -1;
  const std::vector<MarkerSighting>& sightings_;
  size_t minima_;
  ReprojectionParams params_;
  Pivot pivot_;
  Pose origin_;
  Eigen::Matrix3d axes_;  // columns: the two weakest rotations, and the third
  Eigen::Vector2d spacing_;
  double least_ = std::numeric_limits<double>::infinity();
  std::map<Place, int> visited_;  // index of the cell
  std::vector<Grown> queue_;
  std::vector<TiltCell> cells_;
};

}  // namespace

TiltLattice tiltLattice(const std::vector<MarkerSighting>& sightings,
                        const std::vector<PoseHypothesis>& minima, const std::optional<FloorPrior>& floor) {
  return Lattice(sightings, minima, floor).grow();
}

}  // namespace sextant
