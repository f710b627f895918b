"""What an adapter is: it asks one engine one case, and says what the engine promises.

This one asks an imaginary package:

    import time

    import imaginary

    from lin_canny_referee import Adapter, Answer, Tolerance


    class Engine(Adapter):
        package = "imaginary"  # whose version the table states
        precision = "double"  # "single" if it stores points or poses so
        options = {"default": "", "careful": "1,000 iterations"}
        tolerance = Tolerance(absolute=1e-6, relative=1e-6)  # as its documentation says
        answers = ("distance", "depth", "points", "normal")
        code = '''import imaginary
    a, b = imaginary.Hull({a}), imaginary.Hull({b})
    print(imaginary.distance(a, {ta}, {qa}, b, {tb}, {qb}).distance)'''

        def body(self, points, faces):
            return imaginary.Hull(points)  # raise if the body is refused

        def ask(self, a, pose_a, b, pose_b):
            xa = imaginary.Transform(pose_a.position, pose_a.quaternion)
            xb = imaginary.Transform(pose_b.position, pose_b.quaternion)
            start = time.perf_counter_ns()
            r = imaginary.distance(a, xa, b, xb, limit=1000 if self.careful else 50)
            ns = time.perf_counter_ns() - start
            return Answer(r.distance, r.point_a, r.point_b, r.normal, ns)
"""

from __future__ import annotations

import importlib
import importlib.metadata
import importlib.util
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, NamedTuple, Sequence

from .cases import Pose


class Answer(NamedTuple):
    """What an engine answered; None stands for what it does not give."""

    distance: float | None
    """Signed: minus the depth if the bodies overlap."""
    point_a: Sequence[float] | None
    """Witness point of A in the world."""
    point_b: Sequence[float] | None
    normal: Sequence[float] | None
    """From A to B, in the world."""
    nanoseconds: int
    """Of the query alone."""
    state: str | None = None
    """`sep`, `touch` or `pen`, if the sign of the distance does not say it."""


@dataclass(frozen=True)
class Tolerance:
    """Errors that an engine is allowed: `absolute` in units of length, `relative` to the size of the pair."""

    absolute: float = 0.0
    relative: float = 1e-6

    def of(self, size: float) -> float:
        return max(self.absolute, self.relative * size)


class Adapter:
    """Base class: the file `adapters/NAME.py` defines a subclass `Engine` for each engine."""

    package: ClassVar[str]
    """Name of the package, whose version the table states."""
    precision: ClassVar[str] = "double"
    """`single` if the engine stores points or poses in single precision: it is asked cases of such numbers."""
    options: ClassVar[dict[str, str]] = {"default": ""}
    """What `default` and, if the engine has options, `careful` mean."""
    tolerance: ClassVar[Tolerance] = Tolerance()
    """What the engine documents; if nothing, at least 1e-6 of the size."""
    answers: ClassVar[tuple[str, ...]] = ("distance", "depth", "points", "normal")
    """What the engine can answer. A call that gives less has no answer."""
    code: ClassVar[str] = ""
    """Three lines of the engine's own code that ask a case. {a} and {b} stand for the points, {fa} and {fb} for the
    triangles, {ta}, {qa}, {ra}, {tb}, {qb} and {rb} for positions, quaternions x y z w, and rotation matrices,
    {careful} for one of the two texts below."""
    program: ClassVar[list[str] | None] = None
    """A program that answers files of cases itself, in the protocol of `tests/CASES.md`, instead of the methods below.
    `careful_program` holds its further options if it shall be careful. It is asked in the world only."""
    careful_program: ClassVar[list[str]] = []
    version: ClassVar[str | None] = None
    """The version, if `package` is no package of Python."""
    default_code: ClassVar[str] = ""
    careful_code: ClassVar[str] = ""

    def __init__(self, careful: bool) -> None:
        self.careful = careful

    def body(self, points: list[list[float]], faces: list[list[int]]) -> Any:
        """Returns the body in the engine's form; raises if the engine refuses it. A flat body has no faces."""
        raise NotImplementedError

    def ask(self, a: Any, pose_a: Pose, b: Any, pose_b: Pose) -> Answer:
        """Asks one case; raises if the engine gives no answer."""
        raise NotImplementedError

    # Two more methods are optional:
    # `batch(cases)` asks many `(a, pose_a, b, pose_b)` at once, for engines whose call costs far more than its query.
    # `kept(points, faces)` returns the points that the engine keeps, if it rounds or drops some: truth is computed for these.


def triangles(faces: list[list[int]]) -> list[list[int]]:
    """Cuts faces into triangles by fans."""
    if not faces:
        raise ValueError("the body is flat: it has no faces")
    return [[f[0], f[k], f[k + 1]] for f in faces for k in range(1, len(f) - 1)]


def used(points: list[list[float]], faces: list[list[int]]) -> tuple[list[list[float]], list[list[int]]]:
    """Drops points that no face uses."""
    ids = sorted({i for f in faces for i in f})
    place = {i: k for k, i in enumerate(ids)}
    return [points[i] for i in ids], [[place[i] for i in f] for f in faces]


def load(engine: str) -> type[Adapter]:
    """Returns the adapter of a name, or of a file `PATH.py`."""
    if engine.endswith(".py"):
        spec = importlib.util.spec_from_file_location(Path(engine).stem, engine)
        if spec is None or spec.loader is None or not Path(engine).exists():
            raise SystemExit(f"no file {engine}")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module.Engine
    try:
        return importlib.import_module(f"{__package__}.adapters.{engine}").Engine
    except ModuleNotFoundError as error:
        if error.name == f"{__package__}.adapters.{engine}":
            raise SystemExit(f"no engine {engine!r}: {', '.join(names())}, or the file of an adapter") from None
        raise SystemExit(f"engine {engine} is not installed: {error}") from None


def names() -> list[str]:
    """Returns the names of the adapters of this package."""
    folder = Path(__file__).parent / "adapters"
    return sorted(p.stem for p in folder.glob("*.py") if p.stem != "__init__")


def version(engine: type[Adapter]) -> str:
    """Returns the version of the engine's package."""
    if engine.version is not None:
        return engine.version
    try:
        return importlib.metadata.version(engine.package)
    except importlib.metadata.PackageNotFoundError:
        return "unknown"
