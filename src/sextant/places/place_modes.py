# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How pictures of a robot are taken together: each for itself, by a filter over time, or the last ones."""

from collections import deque
from dataclasses import replace
from typing import Callable, Deque, Dict, NamedTuple, Optional

import numpy as np

from sextant.places.place_belief import BeliefParams, PlaceBelief


class Seen(NamedTuple):
    """A picture's evidence; None: it says nothing."""

    log_ratios: Optional[np.ndarray]  # (places,)
    distance: Optional[float]  # that was gone since the last picture; None: nobody knows
    voted: bool = True  # whether log_ratios tell nowhere from places, too


class Single:
    """Every picture for itself."""

    def __init__(self, positions: np.ndarray, params: BeliefParams, window: int):
        self.belief = PlaceBelief(positions, replace(params, trust=1.0, doubt=0.0))

    def update(self, seen: Seen) -> None:
        self.belief.reset()
        if seen.log_ratios is not None:
            self.belief.see(seen.log_ratios, seen.voted)


class Filter:
    """All pictures so far."""

    def __init__(self, positions: np.ndarray, params: BeliefParams, window: int):
        self.belief = PlaceBelief(positions, params)
        self._begun = False

    def update(self, seen: Seen) -> None:
        if self._begun:
            self.belief.move(seen.distance)
        if seen.log_ratios is not None:
            self.belief.see(seen.log_ratios, seen.voted)
        self._begun = True


class Sequence:
    """The last pictures together, of a robot that is somewhere in the map: it is never nowhere.

    What each of them says weakly adds up, in light or a season that the map does not have.
    """

    def __init__(self, positions: np.ndarray, params: BeliefParams, window: int):
        self.belief = PlaceBelief(positions, replace(params, nowhere=0.0, leave=0.0, restart=0.0))
        self._window: Deque[Seen] = deque(maxlen=window)

    def update(self, seen: Seen) -> None:
        self._window.append(seen)
        self.belief.reset()
        for number, each in enumerate(self._window):
            if number:
                self.belief.move(each.distance)
            if each.log_ratios is not None:
                self.belief.see(each.log_ratios, each.voted)


# by name: of positions, parameters of the belief, and the number of pictures in a window
MODES: Dict[str, Callable[[np.ndarray, BeliefParams, int], object]] = {
    "filter": Filter,
    "sequence": Sequence,
    "single": Single,
}
