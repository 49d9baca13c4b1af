"""Drive an aurasim world from Python: join a run or launch one, see its bodies as numpy arrays, act, step it.

    import aurasim

    with aurasim.World.launch("demo", set={"dds.domain": 7}, paused=True) as world:
        ball = world.spawn(aurasim.Shape.sphere(0.5), position=(0, 0, 10), mass=3)
        for _ in range(60):
            bodies = world.step()
        print(bodies.time, bodies.positions[bodies.ids == ball.body])

Lengths in m, times in s, masses in kg, angles in rad, the world's frame; rotations are quaternions w x y z. Every call
raises one of the errors below, at the latest soon after its `timeout` (s). docs/client.md has the rest.
"""

from __future__ import annotations

import atexit
import json
import os
import weakref
from importlib.util import find_spec
from typing import Any, Iterable, Mapping, Sequence, Tuple, Union

import numpy as np

if find_spec(f"{__name__}._aurasim") is None:
    raise ImportError(f"aurasim: the module _aurasim is not in {os.path.dirname(__file__)}. In a build tree: cmake --build "
                      "build/release --target aurasim_python, and PYTHONPATH=build/release/src/python. Or: pip install "
                      "--no-build-isolation .")

from ._aurasim import (  # noqa: F401
    Acknowledgement,
    BadFile,
    Bodies,
    Contacts,
    Ended,
    Error,
    FanHits,
    Joints,
    LaunchFailed,
    NodeStatus,
    NoProgram,
    NoSuchRun,
    Observation,
    RayFan,
    RayHit,
    Refused,
    RunDiffers,
    RunInfo,
    SavedWorld,
    Shape,
    TimedOut,
    Trigger,
    TriggerEvents,
    __version__,
)
from ._aurasim import Observer as _Observer
from ._aurasim import World as _World

__all__ = [
    "Acknowledgement", "BadFile", "Bodies", "Contacts", "Ended", "Error", "FanHits", "Joints", "LaunchFailed",
    "NodeStatus", "NoProgram", "NoSuchRun", "Observation", "Observer", "RayFan", "RayHit", "Refused", "RunDiffers",
    "RunInfo", "SavedWorld", "Shape", "TimedOut", "Trigger", "TriggerEvents", "World", "__version__",
]

Overrides = Union[Mapping[str, Any], Iterable[str]]
Vector = Sequence[float]
Vectors = Tuple[np.ndarray, Union[np.ndarray, None]]
Numbers = Union[float, Sequence[float], np.ndarray]

_ORIGIN = (0.0, 0.0, 0.0)
_UPRIGHT = (1.0, 0.0, 0.0, 0.0)
_open_worlds: weakref.WeakSet[World] = weakref.WeakSet()


def _override_texts(overrides: Overrides) -> list[str]:
    """As --set takes them; JSON is YAML."""
    if not isinstance(overrides, Mapping):
        return [str(text) for text in overrides]
    return [f"{key}={value if isinstance(value, str) else json.dumps(value, default=os.fspath)}"
            for key, value in overrides.items()]


def _for_each(quantity: Vectors | None) -> Vectors | None:
    """One vector for all becomes one for each."""
    if quantity is None or quantity[1] is None or np.ndim(quantity[1]) != 1:
        return quantity
    ids, vector = quantity
    return ids, np.broadcast_to(np.asarray(vector, float), (len(ids), 3))


def _path(path: str | os.PathLike[str] | None) -> str:
    return "" if path is None else os.fspath(path)


class Observer:
    """What `World.observe` has begun. Close it, or use it in a `with` block; it ends with its World, too."""

    def __init__(self, observer: _Observer) -> None:
        self._observer = observer

    def next(self, timeout: float = 60.0) -> Observation:
        """The next state, in order; waits for it. One that has come is kept until it is asked for: up to 256 of them,
        then the oldest go, and `skipped` counts them."""
        return self._observer.next(timeout)

    def close(self) -> None:
        self._observer.close()

    def __enter__(self) -> Observer:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class World:
    """A run: `World.connect` joins one, `World.launch` starts one. Close it, or use it in a `with` block."""

    def __init__(self, world: _World) -> None:
        self._world = world
        self._numbers: dict[str, int] | None = None
        _open_worlds.add(self)

    @classmethod
    def connect(cls, file: str | os.PathLike[str], *, set: Overrides = (), key: str = "", program: str = "",
                log: str = "", timeout: float = 15.0) -> World:
        """Joins a run that was started elsewhere. `file` and `set` as its nodes have them; `key`: a name of
        dds.security; `program`: `aurasim`; `log`: file for the words of the processes that are started."""
        return cls(_World.connect(os.fspath(file), _override_texts(set), key, program, log, timeout))

    @classmethod
    def launch(cls, file: str | os.PathLike[str], *, set: Overrides = (), paused: bool = False,
               load: str | os.PathLike[str] | None = None, report: str | os.PathLike[str] | None = None,
               saves: str | os.PathLike[str] | None = None, spares: int = 0, key: str = "", program: str = "",
               log: str = "", timeout: float = 60.0) -> World:
        """Starts a run on this host, which ends when this World is closed or this program ends. `paused`: it stands in
        state 0; with `load`, a saved world, in the state that was saved. `report`: folder for what the nodes
        record; `saves`: folder for their parts of saved worlds."""
        return cls(_World.launch(os.fspath(file), _override_texts(set), key, program, log, timeout, paused,
                                 _path(load), _path(report), _path(saves), spares))

    def close(self, timeout: float = 30.0) -> int:
        """Ends what it has started, and waits for that. Returns the launcher's exit code, or that of an agent that died
        before (128 + its signal); 0 if nothing was launched."""
        return self._world.close(timeout)

    @property
    def closed(self) -> bool:
        return self._world.closed()

    @property
    def agent_pid(self) -> int:
        """Of the process that speaks DDS for this World; 0: closed."""
        return self._world.agent_pid()

    def __enter__(self) -> World:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # Sense.

    def info(self, timeout: float = 60.0) -> RunInfo:
        return self._world.info(timeout)

    def nodes(self, timeout: float = 60.0) -> list[NodeStatus]:
        """What each node says of itself, by region."""
        return self._world.nodes(timeout)

    def bodies(self, timeout: float = 60.0) -> Bodies:
        """In a paused run the state in which it stands, or will within a second: a step of another client is waited
        for. Else the newest that all regions have published."""
        return self._world.bodies(timeout)

    def ray(self, start: Vector, end: Vector, timeout: float = 60.0) -> RayHit:
        """What is first on the way from `start` to `end`?"""
        return self._world.ray(start, end, timeout)

    def observe(self, *, every: int = 1, all: bool = False, bodies: Iterable[int] = (), patterns: Iterable[str] = (),
                boxes: Iterable[tuple[Vector, Vector]] = (), contacts: bool = False, joints: bool = False,
                fans: Iterable[RayFan] = (), triggers: Iterable[Trigger] = (), timeout: float = 60.0) -> Observer:
        """Begins to observe: only what is asked for is sent. `every`: states whose number is a multiple of it; 0: only
        those in which the run stands. `bodies`: ids; `patterns`: of names of kinds of bodies; `boxes`: (low, high) of
        boxes that a body's origin is in. `contacts`, `joints`: of these bodies. Raises Refused for what cannot be
        asked for."""
        ids = np.fromiter(bodies, dtype=np.uint64)
        return Observer(self._world.observe(every, all, ids, list(patterns), list(boxes), contacts, joints, list(fans),
                                            list(triggers), timeout))

    # Steer.

    def pause(self, timeout: float = 60.0) -> Bodies:
        """Returns the bodies of the state in which all regions stand."""
        return self._world.pause(timeout)

    def step(self, count: int = 1, timeout: float = 60.0) -> Bodies:
        """Computes `count` states more of a paused run; returns the bodies of the last, once all regions have told it.
        Steps of several clients add up: then it may be a later state. Raises Refused at once if the run is not
        paused."""
        return self._world.step(count, timeout)

    def resume(self, timeout: float = 60.0) -> None:
        self._world.resume(timeout)

    def reset(self, timeout: float = 60.0) -> None:
        """The scene, or the saved world that the run has begun with, begins anew. A paused run stands in its first
        state."""
        self._world.reset(timeout)

    def stop(self, timeout: float = 60.0) -> None:
        """Ends the run."""
        self._world.stop(timeout)

    def set_rate(self, rate: float, timeout: float = 60.0) -> Acknowledgement:
        """Simulated seconds per second, 0.01 to 10."""
        return self._world.set_rate(rate, timeout)

    def set_scene(self, name: str, timeout: float = 60.0) -> Acknowledgement:
        """Begins anew with another scene beside the launch file's, or with the same one as its file is now; a paused
        run stands in its state 0."""
        return self._world.set_scene(name, timeout)

    def set_regions(self, boxes: Sequence[Vector], timeout: float = 60.0) -> Acknowledgement:
        """x0 y0 x1 y1 of each region; infinite sides allowed."""
        return self._world.set_regions(boxes, timeout)

    def drain(self, region: int, timeout: float = 60.0) -> int:
        """The region's node leaves, and another process takes it over. Returns that one's number."""
        return self._world.drain(region, timeout)

    # Keep.

    # A saved world has a name, of letters, digits, '.', '_' and '-', and is a file in the nodes' folder of saved worlds
    # (`saves` of launch()). A path is Refused.

    def save(self, name: str, timeout: float = 60.0) -> SavedWorld:
        """Keeps the world. A paused run is saved in the state in which it stands."""
        return self._world.save(name, timeout)

    def load(self, name: str, timeout: float = 60.0) -> Acknowledgement:
        """Goes on from a saved world; a paused run stands in its state."""
        return self._world.load(name, timeout)

    def back(self, timeout: float = 60.0) -> Acknowledgement:
        """Goes back to the newest earlier state that is kept."""
        return self._world.back(timeout)

    # Act. `at`: not before that state. In a paused run, or with `at`, a call returns when the act is certain to come,
    # in the state that it says; else when it has been seen.

    def spawn(self, kind: str | Shape, *, position: Vector = _ORIGIN, rotation: Vector = _UPRIGHT,
              linear_velocity: Vector = _ORIGIN, angular_velocity: Vector = _ORIGIN, mass: float = 1.0, at: int = 0,
              timeout: float = 60.0) -> Acknowledgement:
        """A new body: one of the scene's kinds (RunInfo.prototypes), or a shape with a mass."""
        name, shape = (kind, Shape.sphere(0)) if isinstance(kind, str) else ("", kind)
        return self._world.spawn(name, shape, mass, position, rotation, linear_velocity, angular_velocity, at, timeout)

    def add_static(self, shape: Shape, *, position: Vector = _ORIGIN, rotation: Vector = _UPRIGHT, at: int = 0,
                   timeout: float = 60.0) -> Acknowledgement:
        """A new static, on every node."""
        return self._world.add_static(shape, position, rotation, at, timeout)

    def remove_body(self, body: int, *, at: int = 0, timeout: float = 60.0) -> Acknowledgement:
        return self._world.remove_body(body, at, timeout)

    def remove_static(self, fixed: int, *, at: int = 0, timeout: float = 60.0) -> Acknowledgement:
        return self._world.remove_static(fixed, at, timeout)

    def move_static(self, fixed: int | str, position: Vector, *, rotation: Vector = _UPRIGHT, duration: float = 0.0,
                    at: int = 0, timeout: float = 60.0) -> Acknowledgement:
        """Sends a static, by its number or its name in the scene, to a place: it goes there evenly in `duration` seconds
        of simulated time, pushes what is in its way, and stays there. Solver soft_step only."""
        return self._world.move_static(fixed, position, rotation, duration, at, timeout)

    def impulse(self, body: int, impulse: Vector, *, point: Vector | None = None, at: int = 0,
                timeout: float = 60.0) -> Acknowledgement:
        """N s, at a point or the centre of mass."""
        return self._world.impulse(body, impulse, point, at, timeout)

    def set_velocity(self, body: int, linear: Vector, angular: Vector | None = None, *, at: int = 0,
                     timeout: float = 60.0) -> Acknowledgement:
        """m/s and rad/s; without a spin that stays as it is."""
        return self._world.set_velocity(body, linear, angular, at, timeout)

    def control(self, *, forces: Vectors | None = None, torques: Vectors | None = None,
                velocities: Vectors | None = None, spins: Vectors | None = None, at: int = 0,
                timeout: float = 60.0) -> int:
        """Steers bodies: for each quantity (n ids, n x 3 array) in N, N m, m/s, rad/s, world frame; (ids, one vector)
        is for all of them, (ids, None) lets go of them. What is said holds until something else is said, wherever the
        bodies are hosted. Returns at once, with the first state that shows it: in a paused run by itself the next one; else 0, which is lookahead + 1 states
        after each node has heard of it."""
        of_bodies = (_for_each(of) for of in (forces, torques, velocities, spins))
        return self._world.control(*of_bodies, None, [], at, timeout)

    def drive(self, joints: Sequence[str | int], *, position: Numbers = 0.0, speed: Numbers = 0.0,
              stiffness: Numbers = 0.0, damping: Numbers = 0.0, effort: Numbers = 0.0, max_effort: Numbers = np.inf,
              at: int = 0, timeout: float = 60.0) -> int:
        """Drives hinges and sliders, by name or number (RunInfo.joints): effort = stiffness (position - q) +
        damping (speed - dq/dt) + effort, at most max_effort either way. One number for all or one for each; rad, N m
        or m, N. Like control()."""
        columns = (position, speed, stiffness, damping, effort, max_effort)
        numbers = np.stack([np.broadcast_to(np.asarray(c, float), (len(joints),)) for c in columns], axis=1)
        return self._world.control(None, None, None, None, (self._joints(joints, timeout), numbers), [], at, timeout)

    def release_joints(self, joints: Sequence[str | int], *, at: int = 0, timeout: float = 60.0) -> int:
        """They have the drives of the scene again."""
        return self._world.control(None, None, None, None, (self._joints(joints, timeout), None), [], at, timeout)

    def place(self, fixed: int | str, position: Vector, *, rotation: Vector = _UPRIGHT, states: int = 1, at: int = 0,
              timeout: float = 60.0) -> int:
        """Steers a static, by its number or its name in the scene: a lift, a gate, a conveyor. It is there in state
        `at` + `states` - 1, on the way evenly from where it was, pushes what is in its way, and stays. Like control(),
        but without `at`, in a world that runs, it takes the time of an order; see move_static() for one that waits
        until it is seen. Solver soft_step only."""
        return self._world.control(None, None, None, None, None, [(fixed, position, rotation, states)], at, timeout)

    def _joints(self, joints: Sequence[str | int], timeout: float) -> np.ndarray:
        if any(isinstance(joint, str) for joint in joints) and self._numbers is None:
            self._numbers = {name: number for number, name in enumerate(self.info(timeout).joints)}
        unknown = [joint for joint in joints if isinstance(joint, str) and joint not in self._numbers]
        if unknown:
            raise Refused(f"no joint is called {unknown[0]!r}")
        return np.array([self._numbers[j] if isinstance(j, str) else j for j in joints], np.uint32)

    def impulses(self, bodies: np.ndarray, impulses: np.ndarray, *, at: int = 0,
                 timeout: float = 60.0) -> list[Acknowledgement]:
        """n ids, n x 3: at most 300 between two states. Raises Refused with the first reason if any is refused; the
        others act."""
        return self._world.impulses(bodies, impulses, at, timeout)

    def set_velocities(self, bodies: np.ndarray, linear: np.ndarray, *, at: int = 0,
                       timeout: float = 60.0) -> list[Acknowledgement]:
        """Likewise; n x 3."""
        return self._world.set_velocities(bodies, linear, at, timeout)


@atexit.register
def _close_all() -> None:
    for world in list(_open_worlds):
        world.close()
