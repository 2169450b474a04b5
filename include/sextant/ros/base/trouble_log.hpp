// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>

#include <map>
#include <mutex>
#include <string>

namespace sextant {

/// Counts what went wrong, says each kind once in the log (again after a minute) and lists all in
/// diagnostics.
class TroubleLog {
 public:
  /// @param name of the node or nodelet, as the log shall show it
  explicit TroubleLog(std::string name) : name_(std::move(name)) {}

  /// @param kind short and fixed, e.g. "camera_info"; @param text what is wrong and what to do
  void report(const std::string& kind, const std::string& text);
  /// What somebody asked for is not done: said and counted every time, and work goes on.
  void refused(const std::string& kind, const std::string& text);
  /// A piece of work that went well: what was wrong before is over.
  void succeeded();
  /// Summary (WARN while the last piece of work failed) and a row a kind.
  void fill(diagnostic_updater::DiagnosticStatusWrapper& status) const;

 private:
  struct Kind {
    unsigned long count = 0;
    double last_said = -1e9;  // seconds of the steady clock
  };
  std::string name_;
  mutable std::mutex mutex_;
  std::map<std::string, Kind> kinds_;
  std::string current_;  // empty: the last piece of work went well
};

}  // namespace sextant
