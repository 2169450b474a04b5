// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/residual_correlation.hpp"

#include <algorithm>
#include <cmath>

namespace sextant {
namespace {

constexpr size_t kMaxLag = 300;
constexpr double kNoCorrelation = 0.01;  // correlation at which the sum ends
constexpr double kNoise = 2.0;        // the same, standard deviations of the correlation of independent noise
constexpr int kMinPairs = 50;         // for a correlation
constexpr double kMaxAbsorbed = 0.5;  // of the variance, by the fitted parameters

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

double autocorrelationTime(const std::vector<ResidualSeries>& all) {
  const Products squares = productsAt(all, 0);
  double time = 1.0;
  for (size_t lag = 1; lag <= kMaxLag; ++lag) {
    const Products products = productsAt(all, lag);
    if (products.pairs < kMinPairs || !(squares.sum > 0)) break;
    const double correlation = products.sum / products.pairs / (squares.sum / squares.pairs);
    if (correlation < std::max(kNoCorrelation, kNoise / std::sqrt(8.0 * products.pairs))) break;
    time += 2 * correlation;
  }
  return time;
}

}  // namespace

// A fitted parameter absorbs as much of the variance as one residual has if they are independent, but as much
// as `time` of them have if they are correlated.
double correlatedImages(const std::vector<ResidualSeries>& all, double fitted) {
  double residuals = 0;
  for (const ResidualSeries& series : all) residuals += 8.0 * static_cast<double>(series.size());
  if (residuals == 0) return 1.0;
  const double time = autocorrelationTime(all), share = std::min(fitted / residuals, kMaxAbsorbed);
  return time * (1 - share) / (1 - std::min(share * time, kMaxAbsorbed));
}

}  // namespace sextant
