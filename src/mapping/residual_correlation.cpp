// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/residual_correlation.hpp"

#include <algorithm>

namespace sextant {
namespace {

constexpr size_t kMaxLag = 300;
constexpr double kNoCorrelation = 0.05;  // correlation at which the sum ends
constexpr int kMinPairs = 50;            // for a correlation

struct Products {
  double sum = 0.0;
  int pairs = 0;
};

Products productsAt(const std::vector<ResidualSeries>& all, size_t lag) {
  Products products;
  for (const ResidualSeries& series : all) {
    for (const auto& [image, residual] : series) {
      const auto later = series.find(image + lag);
      if (later == series.end()) continue;
      products.sum += residual.dot(later->second);
      ++products.pairs;
    }
  }
  return products;
}

}  // namespace

double correlatedImages(const std::vector<ResidualSeries>& all) {
  const Products squares = productsAt(all, 0);
  double time = 1.0;
  for (size_t lag = 1; lag <= kMaxLag; ++lag) {
    const Products products = productsAt(all, lag);
    if (products.pairs < kMinPairs || !(squares.sum > 0)) break;
    const double correlation = products.sum / products.pairs / (squares.sum / squares.pairs);
    if (correlation < kNoCorrelation) break;
    time += 2 * correlation;
  }
  return time;
}

}  // namespace sextant
