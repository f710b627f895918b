"""Distances, depths, contacts and casts of moving bodies, with proven bounds.

Lengths are in the caller's unit, angles in radians. Quaternions are x, y, z, w. Returned points and
normals are in the world. Invalid input raises a subclass of LinCannyError, which is a ValueError.
"""

from ._native import (
    Cast,
    Checker,
    Closest,
    FileError,
    Geometry,
    GeometryError,
    LinCannyError,
    MeshFile,
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
    load_mesh,
)

__all__ = [
    "Cast",
    "Checker",
    "Closest",
    "FileError",
    "Geometry",
    "GeometryError",
    "LinCannyError",
    "MeshFile",
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
    "load_mesh",
]
