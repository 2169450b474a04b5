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

/// The elements of an Eigen vector; not owned.
struct Numbers {
  double* first;  ///< first value
  size_t count;   ///< number of values
};

/// Pointer to the value of a parameter; not owned.
using ParamValue =
    std::variant<bool*, int*, double*, std::string*, std::vector<std::string>*, std::vector<double>*, Numbers,
                 std::map<std::string, double>*, std::map<int, double>*, std::map<std::string, std::string>*>;

/// The values that a parameter may have.
struct Allowed {
  /// Throws std::invalid_argument, with a text that begins with the parameter's name, if its value is not
  /// allowed.
  using Check = std::function<void(const Param&)>;

  Allowed() = default;          ///< any value
  Allowed(const Range& range);  ///< applies to each number of a list or table
  /// @param in_words the range as text for the documentation, Markdown
  Allowed(const Range& range, std::string in_words);
  /// @param in_words the requirement as text for the documentation, Markdown
  Allowed(std::string in_words, Check requirement)
      : text(std::move(in_words)), check(std::move(requirement)) {}

  std::string text;  ///< allowed values for the documentation, Markdown
  Check check;       ///< empty: every value is allowed
};

Allowed oneOf(const std::vector<std::string>& words);  ///< a text from this list
Allowed notEmpty();                                    ///< a text of at least one character
Allowed topics();                                      ///< a list of distinct topic names

/// A parameter of a struct. The function fields() of the struct is the only place that describes it:
///
///     ParamList DetectorParams::fields() {
///       return {{"decimate", &decimate, Range::closed(1, 8), "", "AprilTag: quads are searched in ..."}};
///     }
struct Param {
  std::string name;            ///< name, relative to the parameter's namespace
  ParamValue value;            ///< points into the struct
  Allowed allowed;             ///< allowed values
  const char* unit;            ///< as text, e.g. m, px or bits; empty for a value without a unit
  const char* description;     ///< Markdown, one line
  bool may_be_number = false;  ///< also accepts a number, because roslaunch passes the text 0 as one
};

using ParamList = std::vector<Param>;

/// The parameters of a nested struct, with a prefix before each name.
ParamList prefixed(const std::string& prefix, ParamList params);
/// All parameters of several lists, in order.
ParamList joined(std::initializer_list<ParamList> lists);

/// Returns the type for the documentation: "bool", "int", "double", "string", "list of strings", "list of
/// doubles", "dictionary of doubles" or "dictionary of strings".
std::string typeName(const ParamValue& value);

/// Checks every parameter.
/// @throws std::invalid_argument with the name of the first parameter out of range
void requireAllowed(const ParamList& params);

/// Checks every field of a params struct. @throws as requireAllowed()
template <typename Params>
void validate(Params params) {
  requireAllowed(params.fields());
}

}  // namespace sextant
