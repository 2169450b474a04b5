# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Rounds of a robot that is carried to other places, and wakes up at an unknown one.

It is relocalized when its pose has been right for HOLDS seconds: within RIGHT of the true one, with a
standard deviation below SURE. It is at a wrong place if it was moved to another pose, off by more than WRONG,
and is sure of it for LONG seconds: a robot that did not notice yet that it was carried is not.

The RMSE of the best single system is that of the system with the smallest error at each instant. NEES is over
three degrees of freedom, without the time from a kidnapping until the robot was relocalized.
"""

from concurrent.futures import ProcessPoolExecutor
from typing import Dict, List, NamedTuple, Optional

import numpy as np
from tables import Row, Table, Value

from one_pose.rounds import SYSTEMS, Look, looks
from sextant.geometry.plane_poses import composed, relative
from sextant.simulation.building_round import RoundParams

ROUNDS, FIRST_SEED = 40, 12000  # the seeds below were used to choose parameters
QUICK_ROUNDS, QUICK_DURATION = 2, 90.0  # seconds
RIGHT, SURE, HOLDS = 1.0, 1.0, 2.0  # metres, metres, seconds
WRONG, LONG, SAME = 3.0, 5.0, 2.0  # metres, seconds, metres
MEDIAN, MOST = 15.0, 60.0  # seconds until it is relocalized, and for 95 %
COLUMNS = [
    "kidnappings",
    "relocalized, %",
    "after, s (median)",
    "95 %",
    "at a wrong place",
    "with a pose, % of when one has one",
    "RMSE, m",
    "over that of the best single",
    "NEES / 3",
]
ONE = "one pose"


class Kidnapping(NamedTuple):
    """What became of the robot until the next one, or the end."""

    after: Optional[float]  # seconds until it was relocalized; None: it was not
    is_wrong: bool  # whether it was at a wrong place


class Round(NamedTuple):
    """Of one robot."""

    kidnappings: List[Kidnapping]
    distances: np.ndarray  # (n,) of the pose from the true one, metres; infinite: no pose
    nees: np.ndarray  # (m,) over three


def kidnapping_tables(quick: bool) -> List[Table]:
    """One table; a quick run has few short rounds, without bars."""
    rounds, duration = (QUICK_ROUNDS, QUICK_DURATION) if quick else (ROUNDS, 600.0)
    kinds: Dict[str, List[str]] = {ONE: list(SYSTEMS), **{f"{name} alone": [name] for name in SYSTEMS}}
    jobs = [(FIRST_SEED + k, duration, systems) for systems in kinds.values() for k in range(rounds)]
    with ProcessPoolExecutor() as pool:
        done = list(pool.map(driven, *zip(*jobs)))
    found = {name: done[k * rounds : (k + 1) * rounds] for k, name in enumerate(kinds)}
    best = [np.min([found[f"{name} alone"][k].distances for name in SYSTEMS], axis=0) for k in range(rounds)]
    rows: List[Row] = [
        (name, _figures(each, best, name == ONE and not quick)) for name, each in found.items()
    ]
    title = f"{rounds} rounds of {duration:g} s through a building, odometry 5 % off"
    return [Table(title, COLUMNS, rows)]


def driven(seed: int, duration: float, systems: List[str]) -> Round:
    """One round."""
    kidnappings = max(1, round(duration / 120))
    params = RoundParams(seed=seed, duration=duration, kidnappings=kidnappings)
    return judged(list(looks(seed, params, systems)))


def judged(all_looks: List[Look]) -> Round:
    """The outcome of each kidnapping: the first look counts as one."""
    starts = [0, *(index for index, look in enumerate(all_looks) if look.is_kidnapped)]
    outcomes: List[Kidnapping] = []
    nees: List[float] = []
    for begin, end in zip(starts, [*starts[1:], len(all_looks)]):
        part, last = all_looks[begin:end], all_looks[begin - 1] if begin else None
        outcomes.append(Kidnapping(_relocalized_after(part), _is_at_a_wrong_place(part, last)))
        nees += _nees(part, outcomes[-1].after)
    return Round(outcomes, np.array([look.distance for look in all_looks]), np.array(nees))


def _nees(part: List[Look], after: Optional[float]) -> List[float]:
    """Over three, since the robot was relocalized."""
    since = [] if after is None else [look for look in part if look.stamp - part[0].stamp >= after]
    return [look.nees / 3 for look in since if look.pose is not None]


def _durations(part: List[Look], is_so: List[bool]) -> List[float]:
    """For how long it has been so at each look, seconds."""
    lengths = [0.0]
    for look, following, holds in zip(part, part[1:], is_so):
        lengths.append(lengths[-1] + following.stamp - look.stamp if holds else 0.0)
    return lengths


def _relocalized_after(part: List[Look]) -> Optional[float]:
    lengths = _durations(part, [look.distance < RIGHT and look.sigma < SURE for look in part])
    found = next((look for look, length in zip(part, lengths) if length >= HOLDS), None)
    return None if found is None else max(0.0, found.stamp - HOLDS - part[0].stamp)


def _is_at_a_wrong_place(part: List[Look], last: Optional[Look]) -> bool:
    is_off = [look.distance > WRONG and look.sigma < SURE and not _is_unaware(look, last) for look in part]
    return max(_durations(part, is_off)) >= LONG


def _is_unaware(look: Look, last: Optional[Look]) -> bool:
    """Whether the pose is still that of odometry since the kidnapping."""
    if last is None or last.pose is None or look.pose is None:
        return False
    expected = composed(last.pose, relative(last.T_odom_base, look.T_odom_base))
    driven_since = np.hypot(*relative(last.T_odom_base, look.T_odom_base)[:2])
    return float(np.hypot(*(expected - look.pose)[:2])) < SAME + 0.1 * driven_since


def _figures(rounds: List[Round], best: List[np.ndarray], has_bars: bool) -> List[Value]:
    outcomes = [each for one in rounds for each in one.kidnappings]
    after = np.array([np.inf if each.after is None else each.after for each in outcomes])
    distances, singles = np.concatenate([one.distances for one in rounds]), np.concatenate(best)
    both = np.isfinite(distances) & np.isfinite(singles)
    ratio = rms(distances[both]) / rms(singles[both])
    nees = np.concatenate([one.nees for one in rounds])
    bar = (lambda value: value) if has_bars else (lambda value: None)
    return [
        Value(len(outcomes), 0),
        Value(100 * np.isfinite(after).mean(), 1),
        Value(_quantile(after, 0.5), 1, at_most=bar(MEDIAN)),
        Value(_quantile(after, 0.95), 1, at_most=bar(MOST)),
        Value(sum(each.is_wrong for each in outcomes), 0, at_most=bar(0)),
        Value(100 * np.isfinite(distances[np.isfinite(singles)]).mean(), 2, at_least=bar(100)),
        Value(rms(distances[np.isfinite(distances)]), 2),
        Value(ratio, 2, at_most=bar(1.0)),
        Value(float(nees.mean()) if len(nees) else float("nan"), 2, at_least=bar(0.8), at_most=bar(1.5)),
    ]


def _quantile(after: np.ndarray, share: float) -> float:
    """Of times that may be infinite."""
    return float(np.sort(after)[min(len(after) - 1, int(share * len(after)))])


def rms(distances: np.ndarray) -> float:
    """Root mean square; NaN of none."""
    return float(np.sqrt(np.mean(distances**2))) if len(distances) else float("nan")
