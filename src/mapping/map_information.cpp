// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "map_information.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>
#include <vector>

#include "sextant/geometry/pose.hpp"

namespace sextant {
namespace {

using Eigen::Index;
using Jacobian = Eigen::SparseMatrix<double, Eigen::RowMajor>;
using Coupling = Eigen::Matrix<double, 6, Eigen::Dynamic>;

// Smallest ratio of a parameter's information, given those before it, to that with all others known.
constexpr double kMinInformationRatio = 1e-13;

// Eliminates the base poses in order of time: block Cholesky decomposition, with the information of the base
// pose and of the next one as the only part of its diagonal in memory.
class Elimination {
 public:
  Elimination(const Jacobian& jacobian, Index bases)
      : jacobian_(jacobian),
        first_(6 * bases),
        map_(Eigen::MatrixXd::Zero(jacobian.cols() - first_, jacobian.cols() - first_)),
        conditional_(Eigen::VectorXd::Zero(map_.cols())),
        to_map_(Coupling::Zero(6, map_.cols())) {}

  // Adds the information of a row of the Jacobian.
  void add(Index row, Index base) {
    Eigen::Matrix<double, 12, 1> poses = Eigen::Matrix<double, 12, 1>::Zero();
    map_entries_.clear();
    for (Jacobian::InnerIterator each(jacobian_, row); each; ++each)
      if (each.col() < first_)
        poses[each.col() - 6 * base] = each.value();
      else
        map_entries_.emplace_back(each.col() - first_, each.value());
    poses_.noalias() += poses * poses.transpose();
    for (size_t i = 0; i < map_entries_.size(); ++i) {
      const auto [column, value] = map_entries_[i];
      to_map_.col(column) += value * poses.head<6>();
      conditional_[column] += value * value;
      for (size_t j = i; j < map_entries_.size(); ++j)
        map_(map_entries_[j].first, column) += value * map_entries_[j].second;
    }
  }

  // Eliminates the base pose. Returns whether it is determined.
  bool eliminate() {
    const Eigen::LLT<Matrix6d> root(poses_.topLeftCorner<6, 6>());
    if (root.info() != Eigen::Success) return false;
    const Matrix6d next = root.matrixL().solve(poses_.topRightCorner<6, 6>());
    const Coupling map = root.matrixL().solve(to_map_);
    subtractSquare(map);
    const Matrix6d rest = poses_.bottomRightCorner<6, 6>() - next.transpose() * next;
    poses_.setZero();
    poses_.topLeftCorner<6, 6>() = rest;
    to_map_.noalias() = -next.transpose() * map;
    return true;
  }

  // Scaled to compare parameters of different units.
  std::optional<Eigen::MatrixXd> covariance() const {
    const Eigen::VectorXd scale = conditional_.cwiseSqrt().cwiseInverse();
    if (!scale.allFinite()) return std::nullopt;
    const Eigen::LLT<Eigen::MatrixXd> root(scale.asDiagonal() * map_ * scale.asDiagonal());
    if (root.info() != Eigen::Success ||
        root.matrixLLT().diagonal().cwiseAbs2().minCoeff() < kMinInformationRatio)
      return std::nullopt;
    const Eigen::MatrixXd inverse = root.solve(Eigen::MatrixXd::Identity(map_.rows(), map_.cols()));
    return scale.asDiagonal() * inverse * scale.asDiagonal();
  }

 private:
  // Only where it is not zero: without odometry, an image has few of the markers.
  void subtractSquare(const Coupling& coupling) {
    std::vector<Index> columns;
    for (Index i = 0; i < coupling.cols(); ++i)
      if (!coupling.col(i).isZero(0.0)) columns.push_back(i);
    for (size_t i = 0; i < columns.size(); ++i)
      for (size_t j = i; j < columns.size(); ++j)
        map_(columns[j], columns[i]) -= coupling.col(columns[i]).dot(coupling.col(columns[j]));
  }

  const Jacobian& jacobian_;
  Index first_;                  // column of the map
  Eigen::MatrixXd map_;          // lower triangle of the information, from the eliminated base poses
  Eigen::VectorXd conditional_;  // of each parameter of the map, with all others known
  Eigen::Matrix<double, 12, 12> poses_ = Eigen::Matrix<double, 12, 12>::Zero();
  Coupling to_map_;
  std::vector<std::pair<Index, double>> map_entries_;
};

// Rows by their first base pose; those without one at the end.
std::vector<std::vector<Index>> rowsByBase(const Jacobian& jacobian, Index bases) {
  std::vector<std::vector<Index>> all(static_cast<size_t>(bases) + 1);
  for (Index i = 0; i < jacobian.rows(); ++i)
    if (const Jacobian::InnerIterator first(jacobian, i); first)
      all[static_cast<size_t>(std::min<Index>(first.col() / 6, bases))].push_back(i);
  return all;
}

}  // namespace

std::optional<Eigen::MatrixXd> mapParameterCovariance(const Jacobian& jacobian, Index bases) {
  Elimination elimination(jacobian, bases);
  const auto rows = rowsByBase(jacobian, bases);
  for (Index base = 0; base <= bases; ++base) {
    for (const Index row : rows[static_cast<size_t>(base)]) elimination.add(row, base);
    if (base < bases && !elimination.eliminate()) return std::nullopt;
  }
  return elimination.covariance();
}

}  // namespace sextant
