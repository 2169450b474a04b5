// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <initializer_list>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "sextant/base/range.hpp"

namespace sextant {

struct Param;

/// As many numbers as an Eigen vector has.
struct Numbers {
  double* first;
  size_t count;
};

using ParamValue =
    std::variant<bool*, int*, double*, std::string*, std::vector<std::string>*, std::vector<double>*, Numbers,
                 std::map<std::string, double>*, std::map<int, double>*, std::map<std::string, std::string>*>;

/// What values a parameter may have.
struct Allowed {
  using Check =
      std::function<void(const Param&)>;  ///< throws std::invalid_argument that begins with its name

  Allowed() = default;
  Allowed(const Range& range);  ///< each number of a list or table
  Allowed(const Range& range, std::string in_words);
  /// @param in_words for the documentation, Markdown
  Allowed(std::string in_words, Check requirement)
      : text(std::move(in_words)), check(std::move(requirement)) {}

  std::string text;
  Check check;
};

/// A text that is one of these.
Allowed oneOf(const std::vector<std::string>& words);
Allowed notEmpty();  ///< a text
Allowed topics();    ///< a list of names of topics, none of them twice

/// A parameter of a struct, whose function fields() is the only home of all that is known of it:
///
///     ParamList DetectorParams::fields() {
///       return {{"decimate", &decimate, Range::closed(1, 8), "", "AprilTag: quads are searched in ..."}};
///     }
struct Param {
  std::string name;
  ParamValue value;  ///< in the struct, not owned
  Allowed allowed;
  const char* unit;
  const char* description;     ///< Markdown, one line
  bool may_be_number = false;  ///< a text such as 0, which roslaunch makes a number: taken, too
};

using ParamList = std::vector<Param>;

/// Those of a part, as a struct that has it names them.
ParamList prefixed(const std::string& prefix, ParamList params);
ParamList joined(std::initializer_list<ParamList> lists);

/// "true/false", "whole", "real", "text", "list of texts", "list of reals", "table of reals", "table of
/// texts"
std::string typeName(const ParamValue& value);

/// @throws std::invalid_argument that names the first parameter out of range
void requireAllowed(const ParamList& params);

template <typename Params>
void validate(Params params) {
  requireAllowed(params.fields());
}

}  // namespace sextant
