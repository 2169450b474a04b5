# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Prints "N passed, M failed, K skipped" over the junit files below a folder; fails unless all is well."""

import sys
import xml.etree.ElementTree as ElementTree
from collections import Counter
from pathlib import Path


def outcome(case):
    """ "passed", "failed" or "skipped", from one <testcase> of gtest, pytest or rosunit."""
    if case.find("failure") is not None or case.find("error") is not None:
        return "failed"
    if case.find("skipped") is not None or case.get("status") == "notrun":
        return "skipped"
    return "passed"


def is_wrapper(case):
    """rostest adds a case for each test program: news only where it failed, by a time-out."""
    return case.get("classname", "").startswith("rostest.") and outcome(case) == "passed"


def name_of(case):
    return f"{case.get('classname')}: {case.get('name')}"


def count(folder):
    """Counter of outcomes over every *.xml below the folder; a file that is no XML is one failure.

    What failed is printed.
    """
    totals = Counter()
    for path in sorted(Path(folder).rglob("*.xml")):
        try:
            cases = [each for each in ElementTree.parse(str(path)).iter("testcase") if not is_wrapper(each)]
            totals.update(map(outcome, cases))
            failed = (each for each in cases if outcome(each) == "failed")
            print("".join(f"FAILED {name_of(each)}\n" for each in failed), end="")
        except ElementTree.ParseError as error:
            print(f"{path}: {error}")
            totals["failed"] += 1
    return totals


def main():
    totals = count(sys.argv[1])
    print("{passed} passed, {failed} failed, {skipped} skipped".format_map(totals))
    return 0 if totals["passed"] and not totals["failed"] else 1


if __name__ == "__main__":
    sys.exit(main())
