// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/code_book.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace sextant {
namespace {

constexpr double kMaxFalseMatch = 1e-7, kMaxFalseExpected = 1e-4;  // probabilities
constexpr double kMinLead = 0.13;  // minimum difference of the correlations of the best two codes
constexpr int kBlurredBits = 36;   // fewer are not enough for patterns of motion blur
constexpr int kDirections = 8, kSteps = 20;
constexpr double kLengths[] = {1.5, 2.5};  // of motion, modules

struct Motion {
  double x, y;  // modules
};

std::vector<Motion> motionsFor(size_t bits) {
  std::vector<Motion> motions = {{0, 0}};
  for (int i = 0; bits >= kBlurredBits && i < kDirections; ++i)
    for (const double length : kLengths)
      motions.push_back(
          {length * std::cos(i * M_PI / kDirections), length * std::sin(i * M_PI / kDirections)});
  return motions;
}

// Weights (modules of the print x bits) of the light that reaches each bit's place during a motion.
Eigen::MatrixXf exposure(const Motion& motion, int width, const std::vector<cv::Point>& bits) {
  Eigen::MatrixXf weights = Eigen::MatrixXf::Zero(width * width, static_cast<Eigen::Index>(bits.size()));
  const auto inside = [width](double at) { return std::clamp(at, 0.0, width - 1.001); };
  for (size_t bit = 0; bit < bits.size(); ++bit)
    for (int step = 0; step < kSteps; ++step) {
      const double share = (step + 0.5) / kSteps - 0.5;
      const double x = inside(bits[bit].x + share * motion.x), y = inside(bits[bit].y + share * motion.y);
      const int left = static_cast<int>(x), top = static_cast<int>(y);
      for (const int dx : {0, 1})
        for (const int dy : {0, 1})
          weights((top + dy) * width + left + dx, static_cast<Eigen::Index>(bit)) +=
              static_cast<float>((1 - std::abs(x - left - dx)) * (1 - std::abs(y - top - dy)) / kSteps);
    }
  return weights;
}

std::vector<int> turnedByAQuarter(int width, const std::vector<cv::Point>& bits) {
  std::map<std::pair<int, int>, int> index;
  for (size_t i = 0; i < bits.size(); ++i) index[{bits[i].x, bits[i].y}] = static_cast<int>(i);
  std::vector<int> turned;
  for (const cv::Point& bit : bits) turned.push_back(index.at({width - 1 - bit.y, bit.x}));
  return turned;
}

// Subtracts the mean of each row and divides by its length.
template <typename Rows>
void normalizeRows(Rows&& rows) {
  rows.colwise() -= rows.rowwise().mean().eval();
  const Eigen::VectorXf lengths = rows.rowwise().norm().cwiseMax(1e-6F);
  rows = lengths.cwiseInverse().asDiagonal() * rows;
}

// Correlation that random grey levels have with one of the patterns with this probability.
double rareCorrelation(double probability, Eigen::Index patterns, size_t bits) {
  const double one = 2 * probability / static_cast<double>(patterns);
  return std::sqrt(1 - std::pow(one, 2.0 / static_cast<double>(bits - 2)));
}

}  // namespace

CodeBook::CodeBook(const Eigen::MatrixXf& prints, int width, const std::vector<cv::Point>& bits)
    : turned_(turnedByAQuarter(width, bits)), ids_(prints.rows()) {
  const std::vector<Motion> motions = motionsFor(bits.size());
  views_ = static_cast<Eigen::Index>(motions.size());
  patterns_.resize(ids_ * views_, static_cast<Eigen::Index>(bits.size()));
  for (Eigen::Index view = 0; view < views_; ++view)
    patterns_.middleRows(view * ids_, ids_) =
        prints * exposure(motions[static_cast<size_t>(view)], width, bits);
  normalizeRows(patterns_);
  min_correlation_ = rareCorrelation(kMaxFalseMatch, 4 * patterns_.rows(), bits.size());
  min_expected_ = rareCorrelation(kMaxFalseExpected, views_, bits.size());
}

// A column for each rotation: the grey levels as they were before that many quarter turns.
CodeBook::Turns CodeBook::turnedBack(const Eigen::VectorXf& greys) const {
  Turns turns(greys.size(), 4);
  turns.col(0) = greys.array() - greys.mean();
  turns.col(0) /= std::max(1e-6F, turns.col(0).norm());
  for (int k = 1; k < 4; ++k)
    for (Eigen::Index i = 0; i < greys.size(); ++i)
      turns(i, k) = turns(turned_[static_cast<size_t>(i)], k - 1);
  return turns;
}

std::optional<CodeMatch> CodeBook::match(const Eigen::VectorXf& greys) const {
  const Eigen::MatrixXf all = patterns_ * turnedBack(greys);
  Eigen::MatrixXf best = all.topRows(ids_);
  for (Eigen::Index view = 1; view < views_; ++view) best = best.cwiseMax(all.middleRows(view * ids_, ids_));
  Eigen::Index id, rotation;
  const float most = best.maxCoeff(&id, &rotation);
  if (!(most >= min_correlation_)) return std::nullopt;
  best(id, rotation) = -1;
  if (most - best.maxCoeff() < kMinLead) return std::nullopt;
  return CodeMatch{static_cast<int>(id), static_cast<int>(rotation), most};
}

bool CodeBook::resembles(const Eigen::VectorXf& greys, int id) const {
  const Eigen::VectorXf upright = turnedBack(greys).col(0);
  for (Eigen::Index view = 0; view < views_; ++view)
    if (patterns_.row(view * ids_ + id).dot(upright) >= min_expected_) return true;
  return false;
}

}  // namespace sextant
