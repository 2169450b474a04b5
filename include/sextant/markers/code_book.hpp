// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core/types.hpp>
#include <optional>
#include <vector>

namespace sextant {

/// A code of a CodeBook that resembles the grey levels of a square's modules.
struct CodeMatch {
  int id;              ///< of the marker
  int rotation;        ///< number of quarter turns, clockwise, by which the upright marker appears turned
  double correlation;  ///< of the grey levels with the code, from -1 to 1
};

/// The codes of a family as grey levels, to find the id of a marker whose bits cannot be distinguished
/// because motion blur or few pixels let its modules run into one another. Codes of at least 36 bits are also
/// compared as they look after a motion by 1.5 and 2.5 modules in each of eight directions: each then has 17
/// patterns.
///
/// Grey levels without a code, with their mean subtracted, are a random direction in n - 1 dimensions. The
/// probability that it has at least the correlation r with one of N patterns, turned any way, is at most
///   4 N (1 - r^2)^((n - 2) / 2) / 2.
/// A match has an r for which this is a ten-millionth, and no other code comes near it. Where one marker
/// is expected, upright, it has to be a ten-thousandth for its own patterns.
class CodeBook {
 public:
  /// @param prints a row for each id: its modules, 1 white and 0 black, row by row, with the border and at
  /// least one module around it
  /// @param width of the prints, modules
  /// @param bits positions of the n bits in the print
  CodeBook(const Eigen::MatrixXf& prints, int width, const std::vector<cv::Point>& bits);

  /// @param greys of the n bits
  /// @return nothing if no code, or more than one, resembles them
  std::optional<CodeMatch> match(const Eigen::VectorXf& greys) const;
  /// Whether they resemble this code, upright.
  bool resembles(const Eigen::VectorXf& greys, int id) const;

 private:
  using Turns = Eigen::Matrix<float, Eigen::Dynamic, 4>;
  Turns turnedBack(const Eigen::VectorXf& greys) const;

  std::vector<int> turned_;   // index of the bit at whose place each bit appears after a quarter turn
  Eigen::Index ids_, views_;  // numbers of codes, and of patterns of each
  Eigen::MatrixXf patterns_;  // a row for each view and id, all ids of a view together: mean 0, length 1
  double min_correlation_, min_expected_;
};

}  // namespace sextant
