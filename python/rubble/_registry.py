"""The scene registry: scenes with arguments, probes and a verdict."""
from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, Callable, NamedTuple, Optional, Union

from . import _abi  # noqa: F401
from ._library import Handle, check, encode, json_of, lib
from ._progress import Progress, ProgressOption
from ._scene import Scene
from ._world import StepReport, World

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._options import RunOptions


class Argument(NamedTuple):
    """A number that a scene can be built with."""

    name: str  #: key of `Scene.from_registry`
    value: float  #: default
    min: Optional[float]  #: smallest value; None: no bound
    max: Optional[float]  #: largest value; None: no bound
    unit: str  #: "1" for none
    doc: str  #: what it changes
    whole: bool  #: whether it is a whole number


class SceneInfo(NamedTuple):
    """A scene of the registry."""

    name: str  #: of the scene
    doc: str  #: what it shows
    steps: int  #: of a full run
    iterations: int  #: that the verdict is stated for
    substeps: int  #: likewise
    tags: list[str]  #: groups that it belongs to
    arguments: list[Argument]  #: numbers that it can be built with


class Claim(NamedTuple):
    """A statement of a verdict: the metric lies in [min, max]; None: no bound."""

    metric: str  #: name of what is measured, with its unit
    min: Optional[float]  #: lower bound
    max: Optional[float]  #: upper bound
    value: Optional[float]  #: None: it was not measured
    holds: bool  #: whether the value is known and within the bounds
    why: str  #: reason of the bounds


class Verdict(NamedTuple):
    """Result of a run."""

    holds: Optional[bool]  #: None: the scene is not from the registry, and nothing was judged
    metrics: dict[str, Optional[float]]  #: all that was measured; None: it could not be
    claims: list[Claim]  #: what the scene must do


def scenes() -> dict[str, SceneInfo]:
    """All scenes of the registry by name."""
    return {each["name"]: SceneInfo(**{**each, "arguments": [Argument(**one) for one in each["arguments"]]})
            for each in json_of(lib.rb_registry)}


class _RunWorld:
    """The world inside a run, which it keeps alive."""

    def __init__(self, run: Handle) -> None:
        self.run, self.held = run, run.held
        self.pointer = ctypes.c_void_p(lib.rb_run_world(run.pointer))


class Run:
    """A run of a registry scene, by name, or of a scene of one's own, with its events and measurements.

    Args:
        scene: Name in the registry, or a `Scene`.
        arguments: Arguments of the registry scene: ``{"base": 10}``.
        options: As for `World`. Iterations, substeps and dt are those of the scene unless given.
    """

    def __init__(self, scene: Union[str, Scene], arguments: Optional[dict[str, float]] = None,
                 **options: Unpack[RunOptions]) -> None:
        self._title = "scene" if isinstance(scene, Scene) else scene
        if isinstance(scene, Scene):
            self._handle = Handle(lib.rb_run_scene, lib.rb_run_destroy, scene._pointer, encode(options))
        else:
            self._handle = Handle(lib.rb_run_create, lib.rb_run_destroy, scene.encode(),
                                  encode(arguments or {}), encode(options))
        self.world = World.__new__(World)  #: the world of the run
        self.world._own(_RunWorld(self._handle))

    @property
    def steps(self) -> int:
        """Number of steps of a full run."""
        return lib.rb_run_steps(self._handle.pointer)

    def step(self) -> StepReport:
        """Applies the events of this step, takes it and measures."""
        report = StepReport()
        check(lib.rb_run_step(self._handle.pointer, ctypes.byref(report._plain)))
        self._handle.held.clear()
        return report

    def run(self, steps: Optional[int] = None,
            observer: Optional[Callable[[World, StepReport], Any]] = None, *,
            progress: ProgressOption = None) -> Verdict:
        """Takes `steps` steps (None: those of a full run) and ends the measurements. `observer` is called
        after each step, and ends the run if it returns False. `progress`: as for `World.step`."""
        count = self.steps if steps is None else steps
        with Progress(progress, self._title, count) as bar:
            for k in range(count):
                report = self.step()
                bar.update(k + 1, report.total_ms)
                if observer is not None and observer(self.world, report) is False:
                    break
        return self.finish()

    def rewound(self) -> None:
        """No longer needed: snapshots hold the events that are not due yet."""
        check(lib.rb_run_rewound(self._handle.pointer))

    def finish(self) -> Verdict:
        """Ends the measurements and judges."""
        found = json_of(lib.rb_run_finish, self._handle.pointer)
        return Verdict(found["holds"], found["metrics"], [Claim(**each) for each in found["claims"]])
