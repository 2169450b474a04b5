// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace sextant {

/// What values a parameter may have.
class Range {
 public:
  static Range closed(double low, double high) { return {low, high, false}; }  ///< [low, high]
  static Range openLow(double low, double high) { return {low, high, true}; }  ///< (low, high]

  /// @throws std::invalid_argument "name is value, allowed is (low, high] unit" where the value is outside or
  /// not a number
  void require(const std::string& name, double value, const std::string& unit = "") const;

 private:
  Range(double low, double high, bool open) : low_(low), high_(high), open_(open) {}

  double low_, high_;
  bool open_;
};

/// @throws std::invalid_argument "name is 'value', allowed is one of ..."
void requireOneOf(const std::string& name, const std::string& value, const std::vector<std::string>& allowed);

}  // namespace sextant
