# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Shows make's output, its standard input, as one line with an estimate of the time left.

All of it goes to a file. On a terminal the line is updated in place, elsewhere a line is printed every half
minute. Warnings and errors are shown as they come.
"""

import re
import sys
import time

PERCENT = re.compile(r"^\[ *(\d+)%\]")
QUIET = re.compile(r"^(Consolidate|Scanning|make(\[\d+\])?: (Ent|Leav)|\[ *\d+%\]|-- |Generating|Wrote|$)")
PAUSE = {True: 0.2, False: 30.0}  # seconds between two lines: terminal, file


def progress(percent: int, seconds: float) -> str:
    """For instance "building: 40 %, 3 min left"; no estimate before there is something to estimate from."""
    if percent < 5:
        return f"building: {percent} %"
    left = seconds * (100 - percent) / percent
    return f"building: {percent} %, " + (f"{left / 60:.0f} min left" if left > 90 else f"{left:.0f} s left")


def show(lines, log, screen, clock=time.monotonic) -> None:
    terminal = screen.isatty()
    begin, shown = clock(), clock()
    for line in lines:
        log.write(line)
        found = PERCENT.match(line)
        if found and clock() - shown >= PAUSE[terminal]:
            shown = clock()
            text = progress(int(found.group(1)), shown - begin)
            screen.write(f"\r\x1b[K{text}" if terminal else f"sextant: {text}\n")
        elif not QUIET.match(line):
            screen.write(("\r\x1b[K" if terminal else "") + line)
        screen.flush()
    if terminal:
        screen.write("\r\x1b[K")


if __name__ == "__main__":
    with open(sys.argv[1], "w", errors="replace") as log_file:
        show(sys.stdin, log_file, sys.stderr)
