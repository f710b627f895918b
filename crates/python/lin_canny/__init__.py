"""Distances, depths, contacts and casts of moving bodies, with proven bounds.

Lengths are in the caller's unit, angles in radians, quaternions are x, y, z, w, points and normals
of answers are in the world. Input that is refused raises a subclass of LinCannyError, a ValueError.
"""

from ._native import (
    Cast,
    Checker,
    Closest,
    FileError,
    Geometry,
    GeometryError,
    LinCannyError,
    MotionError,
    NearPair,
    PairError,
    PairTracker,
    Penetration,
    PlanError,
    PoseError,
    Robot,
    Scene,
    SceneError,
    ScenePair,
    UndecidedError,
    Verdict,
    distances,
)

__all__ = [
    "Cast",
    "Checker",
    "Closest",
    "FileError",
    "Geometry",
    "GeometryError",
    "LinCannyError",
    "MotionError",
    "NearPair",
    "PairError",
    "PairTracker",
    "Penetration",
    "PlanError",
    "PoseError",
    "Robot",
    "Scene",
    "SceneError",
    "ScenePair",
    "UndecidedError",
    "Verdict",
    "distances",
]
