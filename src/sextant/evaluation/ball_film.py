# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plots of a ball task: the camera's images, and the floor from above."""

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
from sextant.simulation.arena_looks import COLOURS
from sextant.simulation.ball_ground import Pillar
from sextant.simulation.ball_simulation import BallSimulation
from sextant.simulation.rgbd_camera import RgbdImages

KINDS = (".png", ".gif")
PERIOD = 0.4  # simulated seconds between frames of an animation
DURATION = 120  # of an animation, milliseconds
STRIP = 6  # number of frames in a strip
SIDE = 3.0  # width of a frame, inches
AROUND = 0.4  # margin of the floor plan, metres
LIGHT = 1.6  # brightness factor of the simulated colours


class Still(NamedTuple):
    """State at one time."""

    stamp: float  # seconds
    state: str  # of the task
    image: np.ndarray  # uint8 (height, width, 3)
    boxes: List[Tuple[np.ndarray, str]]  # detections: (4,) box in pixels, and class
    robot: np.ndarray  # (3,) true x, y, yaw in the world
    ball: np.ndarray  # (2,) true position in the world
    path: np.ndarray  # (n, 2) planned path in the world


class BallFilm:
    """Records a match (see ball_match.play) and draws it."""

    def __init__(self, path: Path):
        """Sets the file to write: a strip (.png) or an animation (.gif).

        :raises ValueError: another ending
        """
        if path.suffix not in KINDS:
            raise ValueError(f"{path}: a film is {' or '.join(KINDS)}")
        self._path = path
        self._stills: List[Still] = []
        self._simulation: Optional[BallSimulation] = None

    def watch(
        self, simulation: BallSimulation, player: BallPlayer, action: Action, picture: Optional[RgbdImages]
    ) -> None:
        """Records the state every PERIOD, and when the task's state changes."""
        self._simulation, robot = simulation, simulation.ground.robot
        last = self._stills[-1] if self._stills else None
        if picture is None or (
            last and last.state == action.state and simulation.ground.stamp < last.stamp + PERIOD
        ):
            return
        start = simulation.world.robot
        # The origin of the player's map is the robot's initial pose.
        path = action.path @ rotation(start[2]).T + start[:2]
        pose = np.array([robot.x, robot.y, robot.yaw])
        still = Still(
            simulation.ground.stamp, action.state, picture.colour, list(player.found), pose,
            simulation.ground.ball.copy(), path,
        )  # fmt: skip
        self._stills.append(still)

    def write(self) -> None:
        """Writes the file.

        :raises OSError: the file cannot be written
        """
        with atomic_file(self._path, "wb") as file:
            if self._path.suffix == ".png":
                self._drawn(self._chosen()).save(file, "PNG", optimize=True)
            else:
                frames = [self._drawn([still]).quantize(64) for still in self._stills]
                rest = frames[1:]
                frames[0].save(file, "GIF", save_all=True, append_images=rest, duration=DURATION, loop=0)

    def _chosen(self) -> List[Still]:
        """Returns the frames of a strip: changes of the state, and frames between them."""
        new = [i for i, each in enumerate(self._stills) if i == 0 or each.state != self._stills[i - 1].state]
        wanted = np.linspace(0, len(self._stills) - 1, STRIP).round().astype(int)
        kicked = [i for i in new if self._stills[i].state in ("approaching", "kicking", "watching", "done")]
        best = sorted({0, len(self._stills) - 1, *kicked[:STRIP]})
        best += [i for i in wanted if i not in best][: max(0, STRIP - len(best))]
        picked = sorted(best)[: STRIP - 1] + [len(self._stills) - 1]
        return [self._stills[i] for i in sorted(set(picked))]

    def _drawn(self, stills: List[Still]) -> Image.Image:
        """Draws frames side by side."""
        figure = Figure(
            figsize=(SIDE * len(stills), SIDE * (0.85 + self._height())), dpi=100, constrained_layout=True
        )
        canvas = FigureCanvasAgg(figure)
        axes = figure.subplots(
            2, len(stills), squeeze=False, gridspec_kw={"height_ratios": [0.85, self._height()]}
        )
        for above, below, still in zip(*axes, stills):
            above.set_title(f"{still.stamp:.1f} s: {still.state}")
            self._draw_camera(above, still)
            self._draw_floor(below, still)
        canvas.draw()
        return Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3])

    def _height(self) -> float:
        """Returns the height of the floor plan over its width."""
        low, high = self._extent()
        return float((high - low)[1] / (high - low)[0])

    def _extent(self) -> Tuple[np.ndarray, np.ndarray]:
        """Returns the corners (2,) of the floor plan."""
        goal = [post[:2] for post in self._simulation.world.pillars[:2]]
        at = np.array(
            [*goal, *(each.ball for each in self._stills), *(each.robot[:2] for each in self._stills)]
        )
        return at.min(axis=0) - AROUND, at.max(axis=0) + AROUND

    @staticmethod
    def _draw_camera(axes: Axes, still: Still) -> None:
        axes.imshow(still.image)
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
        axes.plot(*still.path.T, ":", color="tab:red", lw=1)
        radius, (x, y, yaw) = self._simulation.ground.drive.radius, still.robot
        axes.add_patch(Circle((x, y), radius, fc="0.85", ec="0.2"))
        axes.plot([x, x + radius * np.cos(yaw)], [y, y + radius * np.sin(yaw)], color="0.2")
        low, high = self._extent()
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal", xticks=[], yticks=[])


def _colour(class_name: str) -> np.ndarray:
    return np.clip(LIGHT * np.array(COLOURS[class_name]), 0.0, 1.0) ** (1.0 / 2.2)
