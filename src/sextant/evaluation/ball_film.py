# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of a ball task that is played: what the camera sees, and the floor from above."""

from pathlib import Path
from typing import List, NamedTuple, Optional, Tuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle
from PIL import Image

from sextant.ball.ball_player import BallPlayer
from sextant.ball.task_view import Action
from sextant.base.atomic_file import atomic_file
from sextant.geometry.plane_poses import rotation
from sextant.objects.object_kinds import BALL
from sextant.simulation.ball_ground import Pillar
from sextant.simulation.ball_simulation import COLOURS, BallSimulation
from sextant.simulation.rgbd_camera import RgbdPicture

KINDS = (".png", ".gif")
EVERY = 0.4  # simulated seconds from one picture of an animation to the next
SHOWN = 120  # milliseconds
STRIP = 6  # pictures of a strip
SIDE = 3.0  # inches of a picture
AROUND = 0.4  # metres that are shown about what happens
LIGHT = 1.6  # of the colours that things reflect


class Still(NamedTuple):
    """One moment."""

    stamp: float  # seconds
    state: str
    picture: np.ndarray  # uint8 (height, width, 3)
    boxes: List[Tuple[np.ndarray, str]]  # (4,) corners of what was found, pixels, and its class
    robot: np.ndarray  # (3,) x, y, yaw: truth, map of the world
    ball: np.ndarray  # (2,) truth
    way: np.ndarray  # (n, 2) that the robot wants to go, map of the world


class BallFilm:
    """Watches a match (see ball_match.play) and draws it."""

    def __init__(self, path: Path):
        """:param path: to be written: a strip (.png) or an animation (.gif). :raises ValueError: neither"""
        if path.suffix not in KINDS:
            raise ValueError(f"{path}: a film is {' or '.join(KINDS)}")
        self._path = path
        self._stills: List[Still] = []
        self._simulation: Optional[BallSimulation] = None

    def watch(
        self, simulation: BallSimulation, player: BallPlayer, action: Action, picture: Optional[RgbdPicture]
    ) -> None:
        """One moment; it is kept when EVERY has passed, or something else is done."""
        self._simulation, robot = simulation, simulation.ground.robot
        last = self._stills[-1] if self._stills else None
        if picture is None or (
            last and last.state == action.state and simulation.ground.stamp < last.stamp + EVERY
        ):
            return
        start = simulation.world.robot
        # The player's map begins where the robot did.
        way = action.path @ rotation(start[2]).T + start[:2]
        pose = np.array([robot.x, robot.y, robot.yaw])
        still = Still(
            simulation.ground.stamp, action.state, picture.colour, list(player.found), pose,
            simulation.ground.ball.copy(), way,
        )  # fmt: skip
        self._stills.append(still)

    def write(self) -> None:
        """:raises OSError: it cannot be written"""
        with atomic_file(self._path, "wb") as file:
            if self._path.suffix == ".png":
                self._drawn(self._chosen()).save(file, "PNG", optimize=True)
            else:
                frames = [self._drawn([still]).quantize(64) for still in self._stills]
                frames[0].save(file, "GIF", save_all=True, append_images=frames[1:], duration=SHOWN, loop=0)

    def _chosen(self) -> List[Still]:
        """Where something new begins, and between, until there are enough."""
        new = [i for i, each in enumerate(self._stills) if i == 0 or each.state != self._stills[i - 1].state]
        wanted = np.linspace(0, len(self._stills) - 1, STRIP).round().astype(int)
        kicked = [i for i in new if self._stills[i].state in ("approaching", "kicking", "watching", "done")]
        best = sorted({0, len(self._stills) - 1, *kicked[:STRIP]})
        best += [i for i in wanted if i not in best][: max(0, STRIP - len(best))]
        picked = sorted(best)[: STRIP - 1] + [len(self._stills) - 1]
        return [self._stills[i] for i in sorted(set(picked))]

    def _drawn(self, stills: List[Still]) -> Image.Image:
        """Side by side."""
        figure = Figure(
            figsize=(SIDE * len(stills), SIDE * (0.85 + self._height())), dpi=100, layout="constrained"
        )
        canvas = FigureCanvasAgg(figure)
        axes = figure.subplots(2, len(stills), squeeze=False, height_ratios=[0.85, self._height()])
        for above, below, still in zip(*axes, stills):
            above.set_title(f"{still.stamp:.1f} s: {still.state}")
            self._draw_camera(above, still)
            self._draw_floor(below, still)
        canvas.draw()
        return Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3])

    def _height(self) -> float:
        """Of what is shown of the floor, in its widths."""
        low, high = self._extent()
        return float((high - low)[1] / (high - low)[0])

    def _extent(self) -> Tuple[np.ndarray, np.ndarray]:
        """Corners (2,) of all that matters on the floor."""
        goal = [post[:2] for post in self._simulation.world.pillars[:2]]
        at = np.array(
            [*goal, *(each.ball for each in self._stills), *(each.robot[:2] for each in self._stills)]
        )
        return at.min(axis=0) - AROUND, at.max(axis=0) + AROUND

    @staticmethod
    def _draw_camera(axes: Axes, still: Still) -> None:
        axes.imshow(still.picture)
        for (left, top, right, bottom), name in still.boxes:
            box = Rectangle((left, top), right - left, bottom - top, fill=False, lw=1.5, ec=_colour(name))
            axes.add_patch(box)
        axes.axis("off")

    def _draw_floor(self, axes: Axes, still: Still) -> None:
        world = self._simulation.world
        until = [each for each in self._stills if each.stamp <= still.stamp]
        posts: List[Pillar] = world.pillars[:2]
        axes.plot([post.x for post in posts], [post.y for post in posts], "--", color="tab:blue", lw=1)
        for pillar in world.pillars:
            axes.add_patch(Circle(pillar[:2], pillar.radius, color=_colour(pillar.class_name)))
        axes.plot(*np.array([each.ball for each in until]).T, color=_colour(BALL), lw=1)
        axes.add_patch(
            Circle(still.ball, self._simulation.ground.ball_params.radius, fc=_colour(BALL), ec="0.3")
        )
        axes.plot(*np.array([each.robot[:2] for each in until]).T, color="0.6", lw=1)
        axes.plot(*still.way.T, ":", color="tab:red", lw=1)
        radius, (x, y, yaw) = self._simulation.ground.drive.radius, still.robot
        axes.add_patch(Circle((x, y), radius, fc="0.85", ec="0.2"))
        axes.plot([x, x + radius * np.cos(yaw)], [y, y + radius * np.sin(yaw)], color="0.2")
        low, high = self._extent()
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal", xticks=[], yticks=[])


def _colour(class_name: str) -> np.ndarray:
    return np.clip(LIGHT * np.array(COLOURS[class_name]), 0.0, 1.0) ** (1.0 / 2.2)
