// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/explored_area.hpp"

#include <cmath>

namespace sextant {
namespace {

constexpr double kCellsInRange = 12;  // from the sensor to its maximum range
constexpr int kMostCells = 1 << 20;   // a larger area counts as unexplored
constexpr int kMargin = 8;            // cells by which the grid grows at least

}  // namespace

void ExploredArea::look(const Pose2& T_map_sensor, const LandmarkSensor& sensor) {
  if (side_ == 0) side_ = sensor.maxRange() / kCellsInRange;
  const Eigen::Vector2d& from = T_map_sensor.position;
  if (from.norm() > side_ * kMostCells) return;
  const Index2 first = indexOf(from.array() - sensor.maxRange()),
               last = indexOf(from.array() + sensor.maxRange());
  if (!growTo(first, last)) return;
  const Pose2 T_sensor_map = T_map_sensor.inverse();
  for (int y = first.y(); y <= last.y(); ++y)
    for (int x = first.x(); x <= last.x(); ++x) {
      const Eigen::Vector2d centre = side_ * Eigen::Vector2d(x + 0.5, y + 0.5);
      if (!sensor.isInView(T_sensor_map * centre)) continue;
      Cell& cell = cells_[at({x, y})];
      if (cell.looks > 0 && !isNewView(cell.from.cast<double>(), from, centre)) continue;
      cell.from = from.cast<float>();
      ++cell.looks;
    }
}

int ExploredArea::looks(const Eigen::Vector2d& position) const {
  if (side_ == 0 || position.norm() > side_ * kMostCells) return 0;
  const Index2 index = indexOf(position);
  return isInside(index) ? cells_[at(index)].looks : 0;
}

ExploredArea::Index2 ExploredArea::indexOf(const Eigen::Vector2d& position) const {
  return (position / side_).array().floor().cast<int>();
}

bool ExploredArea::isInside(const Index2& index) const {
  return (index >= low_).all() && (index < low_ + size_).all();
}

size_t ExploredArea::at(const Index2& index) const {
  return static_cast<size_t>(index.y() - low_.y()) * size_.x() + static_cast<size_t>(index.x() - low_.x());
}

/// @returns whether there is room for these indices
bool ExploredArea::growTo(const Index2& low, const Index2& high) {
  if (!cells_.empty() && isInside(low) && isInside(high)) return true;
  ExploredArea grown;
  grown.side_ = side_;
  grown.low_ = (cells_.empty() ? low : low_.min(low)) - kMargin;
  grown.size_ = (cells_.empty() ? high : (low_ + size_).max(high)) + kMargin + 1 - grown.low_;
  if (static_cast<double>(grown.size_.x()) * grown.size_.y() > kMostCells) return false;
  grown.cells_.resize(static_cast<size_t>(grown.size_.x()) * grown.size_.y());
  for (int y = low_.y(); y < low_.y() + size_.y(); ++y)
    for (int x = low_.x(); x < low_.x() + size_.x(); ++x) grown.cells_[grown.at({x, y})] = cells_[at({x, y})];
  *this = std::move(grown);
  return true;
}

}  // namespace sextant
