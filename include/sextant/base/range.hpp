// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace sextant {

/// An interval of real numbers.
class Range {
 public:
  static Range closed(double low, double high) { return {low, high, '[', ']'}; }    ///< [low, high]
  static Range openLow(double low, double high) { return {low, high, '(', ']'}; }   ///< (low, high]
  static Range openHigh(double low, double high) { return {low, high, '[', ')'}; }  ///< [low, high)

  /// Checks a value.
  /// @throws std::invalid_argument "name is value, allowed is (low, high] unit" for NaN or a value outside
  void require(const std::string& name, double value, const std::string& unit = "") const;
  std::string text() const;  ///< "(low, high]"

 private:
  Range(double low, double high, char left, char right)
      : low_(low), high_(high), left_(left), right_(right) {}

  double low_, high_;
  char left_, right_;
};

}  // namespace sextant
