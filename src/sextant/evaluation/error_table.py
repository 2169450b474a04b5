# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Table of the absolute trajectory errors of several estimates."""

from typing import Mapping

import numpy as np

from sextant.evaluation.trajectory_metrics import TrajectoryErrors, summarize


def error_table(errors: Mapping[str, TrajectoryErrors]) -> str:
    """Formats mean, 95 % and worst error in cm and degrees and the number of poses, one line per name."""
    width = max(map(len, errors), default=0)
    indent = " " * width
    columns = f"{'mean':>7} {'95 %':>7} {'worst':>8}"
    lines = [
        f"{indent}   position error, cm         angle error, degrees       frames",
        f"{indent} {columns}   {columns}   with a pose",
    ]
    lines += [_table_line(name.ljust(width), series) for name, series in errors.items()]
    return "\n".join(lines)


def _table_line(name: str, errors: TrajectoryErrors) -> str:
    position, angle = summarize(errors.position * 100.0), summarize(np.degrees(errors.angle))
    numbers = "   ".join(f"{each.mean:7.2f} {each.p95:7.2f} {each.worst:8.2f}" for each in (position, angle))
    return f"{name} {numbers}   {len(errors.stamps)} of {errors.frames}"
