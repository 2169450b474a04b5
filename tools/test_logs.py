# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Splits ctest's log into a file for each test; prints the paths of those that failed."""

import re
import sys
from pathlib import Path

TEST = re.compile(
    r"^\d+/\d+ Testing: (?:_ctest_sextant_)?(?P<name>\S+)\n.*?^Output:\n-+\n(?P<output>.*?)<end of output>\n"
    r"Test time = +(?P<seconds>[\d.]+) sec\n-+\n(?P<outcome>[^\n]*)",
    re.M | re.S,
)


def split(log: str, folder: Path) -> None:
    """:param log: the text of ctest's LastTest.log"""
    folder.mkdir(parents=True, exist_ok=True)
    for test in TEST.finditer(log):
        path = folder / (test["name"].replace("rostest_test_ros_", "") + ".log")
        path.write_text(test["output"])
        if test["outcome"] != "Test Passed.":
            print(f"FAILED after {float(test['seconds']):.0f} s: {test['name']}, see {path}")


if __name__ == "__main__":
    split(Path(sys.argv[1]).read_text(errors="replace"), Path(sys.argv[2]))
