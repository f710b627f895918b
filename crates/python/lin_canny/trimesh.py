"""The twin of `trimesh.collision` over this package: the same methods and results, without FCL.

Write `from lin_canny.trimesh import CollisionManager` in place of
`from trimesh.collision import CollisionManager`. Poses are homogeneous matrices, shape (4, 4).

Departures from `trimesh.collision`:

1. A watertight mesh is a solid: an object inside of it is in collision. FCL uses its triangles
   only.
2. A transform keeps double precision, and may scale, shear or reflect.
3. `index` returns the triangle closest to the point, for convex meshes too.
4. The normal points from the first object to the second: from this manager to the other manager or
   to the single mesh, and within one manager from the name that is first in order.
5. A pair of convex meshes has one contact, the deepest. Other pairs have up to four points for each
   group of contacts, in place of one for each pair of triangles.
6. Two meshes that overlap have the distance 0 if one of them is not convex.
7. Without any pair, the distance is infinite and the names are None.
"""

from __future__ import annotations

import math
import weakref
from collections.abc import Hashable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._native import Geometry, GeometryError, PairTracker, PoseError, Scene, closest_points

__all__ = ["CollisionManager", "ContactData", "DistanceData", "scene_to_collision"]

_EXTERNAL = "__external"
# Largest entry of |R^T R - 1| of a matrix that is a rotation.
_RIGID = 1e-6


class _Body:
    """The geometry of a mesh: its hull if it is convex, else the mesh itself."""

    def __init__(self, mesh: Any) -> None:
        if not (hasattr(mesh, "vertices") and hasattr(mesh, "faces")):
            Geometry.from_trimesh(mesh)  # raises the error
        self.vertices = np.array(mesh.vertices, dtype=np.float64)
        self.faces = np.array(mesh.faces, dtype=np.int64)
        self.is_convex = bool(mesh.is_convex)
        self.geometry = self._geometry()
        self._triangles: Geometry | None = None

    def _geometry(self) -> Geometry:
        if self.is_convex:
            try:
                return Geometry.hull(self.vertices)
            except GeometryError:  # flat
                self.is_convex = False
        return Geometry.mesh(self.vertices, self.faces)

    def transformed(self, linear: NDArray[np.float64]) -> _Body:
        """Return the body with all vertices multiplied by a matrix."""
        body = _Body.__new__(_Body)
        body.vertices = self.vertices @ linear.T
        body.faces = self.faces if np.linalg.det(linear) > 0 else self.faces[:, ::-1]
        body.is_convex = self.is_convex
        body.geometry = body._geometry()
        body._triangles = None
        return body

    def triangle_at(self, point: NDArray[np.float64]) -> int:
        """Return the index of the triangle closest to a point, in the frame of the body."""
        if self._triangles is None:
            mesh = Geometry.mesh(self.vertices, self.faces) if self.is_convex else self.geometry
            self._triangles = mesh
        return int(closest_points(self._triangles, point[None])[2][0])


# The body of each mesh. The hash of a mesh is that of its vertices and faces, so a mesh that
# changes is converted again.
_bodies: weakref.WeakKeyDictionary[Any, _Body] = weakref.WeakKeyDictionary()


def _body_of(mesh: Any) -> _Body:
    try:
        found = _bodies.get(mesh)
    except TypeError:  # neither hashed nor referred to
        return _Body(mesh)
    if found is None:
        found = _bodies[mesh] = _Body(mesh)
    return found


class _Poses:
    """Tells rigid motions from other matrices, faster than numpy does."""

    def __init__(self) -> None:
        self._scene = Scene()
        self._id = self._scene.insert(Geometry.point([0, 0, 0]))

    def check(self, matrix: NDArray[np.float64]) -> None:
        """Raise PoseError if a matrix of shape (4, 4) is not a rigid motion."""
        self._scene.set_pose(self._id, matrix)


class _Object:
    """A body at a pose. `moves` counts the poses, so that scenes see the last one."""

    def __init__(self, source: _Body, transform: ArrayLike | None, poses: _Poses) -> None:
        self.source = source
        self._poses = poses
        self.body = source
        self.pose = np.eye(4)
        self.moves = 0
        self.place(transform)

    def place(self, transform: ArrayLike | None) -> None:
        """Set the pose. What the matrix does beyond a rigid motion becomes part of the body."""
        matrix = np.eye(4) if transform is None else np.array(transform, dtype=np.float64)
        if matrix.shape != (4, 4):
            raise PoseError(f"transform: shape is {matrix.shape} (expected (4, 4))")
        body = self.source
        try:
            self._poses.check(matrix)
        except PoseError:
            linear = matrix[:3, :3].copy()
            with np.errstate(invalid="ignore"):
                error = np.abs(linear.T @ linear - np.eye(3)).max()
            if not np.isfinite(error) or (error <= _RIGID and np.linalg.det(linear) >= 0):
                raise
            body = self.source.transformed(linear)
            matrix[:3, :3] = np.eye(3)
            self._poses.check(matrix)
        self.body, self.pose = body, matrix
        self.moves += 1


class _Placed(NamedTuple):
    """An object as a scene has it."""

    id: int
    body: _Body
    moves: int


class _Side:
    """One group of a scene: the objects of a manager, or a single mesh."""

    def __init__(self, scene: Scene, group: int) -> None:
        self.scene, self.group = scene, group
        self.placed: dict[Hashable, _Placed] = {}
        self.names: dict[int, Hashable] = {}

    def update(self, objects: dict[Hashable, _Object]) -> None:
        """Insert, move and remove bodies of the scene, until they are these objects."""
        for name, placed in list(self.placed.items()):
            known = objects.get(name)
            if known is None or known.body is not placed.body:
                self.scene.remove(placed.id)
                del self.placed[name], self.names[placed.id]
        for name, each in objects.items():
            before = self.placed.get(name)
            if before is None:
                id = self.scene.insert(each.body.geometry, each.pose, group=self.group)
                self.names[id] = name
            elif before.moves != each.moves:
                id = before.id
                self.scene.set_pose(id, each.pose)
            else:
                continue
            self.placed[name] = _Placed(id, each.body, each.moves)


class _World:
    """A scene of the pairs within one manager, or between a manager and other objects."""

    def __init__(self, is_internal: bool) -> None:
        self.scene = Scene()
        self.first = _Side(self.scene, 0)
        self.second = self.first if is_internal else _Side(self.scene, 1)
        self.scene.set_queries(self.first.group, self.second.group, overlap=True)
        # The pair that was last found to touch, and its tracker: mostly it still touches.
        self.last: tuple[Hashable, Hashable] = (None, None)
        self.tracker = PairTracker()

    def still_touches(self, first: dict[Hashable, _Object], second: dict[Hashable, _Object]) -> bool:
        """Return whether the last pair that touched touches now."""
        a, b = first.get(self.last[0]), second.get(self.last[1])
        if a is None or b is None:
            return False
        return self.tracker.intersects(a.body.geometry, b.body.geometry, a.pose, b.pose)

    def step(self, first: dict[Hashable, _Object], second: dict[Hashable, _Object]) -> None:
        self.first.update(first)
        if self.second is not self.first:
            self.second.update(second)
        self.scene.step()

    def named(self, a: int, b: int) -> tuple[bool, Hashable, Hashable]:
        """Return whether the ids are exchanged, and the names of both objects."""
        if self.second is self.first:
            names = (self.first.names[a], self.first.names[b])
            is_exchanged = names != _sorted(names)
        else:
            is_exchanged = a not in self.first.names
        if is_exchanged:
            a, b = b, a
        return is_exchanged, self.first.names[a], self.second.names[b]


class _Witness:
    """The names of two objects, and a point on each."""

    def __init__(self, names: tuple[Any, Any], objects: tuple[_Object, _Object], points: Any) -> None:
        self.names = set(names)
        self._of: dict[Hashable, tuple[_Body, NDArray[np.float64], NDArray[np.float64]]] = {
            name: (each.body, each.pose, point) for name, each, point in zip(names, objects, points)
        }

    def index(self, name: Hashable) -> int:
        """Return the index of the triangle at the point, of the mesh with this name."""
        body, pose, point = self._of[name]
        return body.triangle_at(pose[:3, :3].T @ (point - pose[:3, 3]))


class ContactData(_Witness):
    """A contact: `names`, and the properties `point`, `normal` and `depth`."""

    def __init__(
        self,
        names: tuple[Any, Any],
        objects: tuple[_Object, _Object],
        points: Any,
        normal: NDArray[np.float64],
        depth: float,
    ) -> None:
        super().__init__(names, objects, points)
        self._point: NDArray[np.float64] = 0.5 * (points[0] + points[1])
        self._normal = normal
        self._depth = float(depth)

    @property
    def normal(self) -> NDArray[np.float64]:
        """The unit normal from the first object to the second, shape (3,)."""
        return self._normal

    @property
    def point(self) -> NDArray[np.float64]:
        """The middle of the two points of the contact, shape (3,)."""
        return self._point

    @property
    def depth(self) -> float:
        """The penetration depth at the contact, at least 0."""
        return self._depth


class DistanceData(_Witness):
    """The closest points of two objects: `names` and the property `distance`."""

    def __init__(self, names: tuple[Any, Any], objects: tuple[_Object, _Object], points: Any, distance: float) -> None:
        super().__init__(names, objects, points)
        self._distance = distance

    @property
    def distance(self) -> float:
        """The signed distance of the two objects."""
        return self._distance

    def point(self, name: Hashable) -> NDArray[np.float64]:
        """Return the closest point on the mesh with this name, shape (3,)."""
        _, _, point = self._of[name]
        return point


def _sorted(names: tuple[Any, Any]) -> tuple[Any, Any]:
    a, b = names
    return (a, b) if a is None or a <= b else (b, a)


def _contacts(names: tuple[Any, Any], objects: tuple[_Object, _Object]) -> list[ContactData]:
    """Return the contacts of two objects that overlap."""
    a, b = objects
    pair = (a.body.geometry, b.body.geometry, a.pose, b.pose)
    tracker = PairTracker()
    if not (a.body.is_convex and b.body.is_convex):
        found = tracker.contacts(*pair)
        rows = [
            ContactData(names, objects, (row["point_a"], row["point_b"]), row["normal"], -row["separation"])
            for row in found[found["separation"] <= 0]
        ]
        if rows:
            return rows
    closest = tracker.closest(*pair)
    depth = max(-closest.distance, 0.0)
    if not (a.body.is_convex and b.body.is_convex):
        bounds = tracker.penetration(*pair)
        depth = 0.0 if bounds is None else bounds.upper
    return [ContactData(names, objects, (closest.point_a, closest.point_b), closest.normal, depth)]


class CollisionManager:
    """Objects with names, and queries of their collisions and distances.

    The twin of `trimesh.collision.CollisionManager`; the head of this module lists the departures.
    """

    def __init__(self) -> None:
        self._poses = _Poses()
        self._objs: dict[Hashable, _Object] = {}
        self._single: dict[Hashable, _Object] = {}
        # The scenes of queries so far: bodies that did not move cost nothing in the next query.
        self._internal_world: _World | None = None
        self._named_world: _World | None = None
        self._single_world: _World | None = None
        self._other_worlds: weakref.WeakKeyDictionary[CollisionManager, _World] = weakref.WeakKeyDictionary()

    def add_object(self, name: Hashable, mesh: Any, transform: ArrayLike | None = None) -> Geometry:
        """Add an object, or replace the object of this name. Return its geometry.

        mesh: a trimesh.Trimesh, or any object with `vertices`, `faces` and `is_convex`. Raises
        GeometryError for another object, and PoseError for an invalid transform; the manager is
        then unchanged.
        """
        each = _Object(_body_of(mesh), transform, self._poses)
        self._objs[name] = each
        return each.body.geometry

    def remove_object(self, name: Hashable) -> None:
        """Remove an object. Raises ValueError if there is none of this name."""
        self._known(name)
        del self._objs[name]

    def set_transform(self, name: Hashable, transform: ArrayLike) -> None:
        """Set the pose of an object. Raises ValueError if there is none of this name."""
        self._known(name).place(transform)

    def in_collision_single(
        self, mesh: Any, transform: ArrayLike | None = None, return_names: bool = False, return_data: bool = False
    ) -> Any:
        """Return whether a mesh touches any object of the manager.

        With `return_names` also the set of names of all such objects, with `return_data` also a
        list of ContactData, in which the mesh is called "__external".
        """
        world = self._with_single(mesh, transform)
        return self._collisions(world, self._single, lambda names: names[0], return_names, return_data)

    def in_collision_internal(self, return_names: bool = False, return_data: bool = False) -> Any:
        """Return whether any two objects of the manager touch.

        With `return_names` also the set of sorted tuples of two names, with `return_data` also a
        list of ContactData.
        """
        return self._collisions(self._internal(), self._objs, _sorted, return_names, return_data)

    def in_collision_other(
        self, other_manager: CollisionManager, return_names: bool = False, return_data: bool = False
    ) -> Any:
        """Return whether any object of this manager touches any object of another.

        With `return_names` also the set of tuples of two names, first of this manager, then of the
        other; with `return_data` also a list of ContactData.
        """
        world = self._with_other(other_manager)
        return self._collisions(world, other_manager._objs, lambda names: names, return_names, return_data)

    def min_distance_single(
        self, mesh: Any, transform: ArrayLike | None = None, return_name: bool = False, return_data: bool = False
    ) -> Any:
        """Return the least signed distance of a mesh to any object of the manager.

        With `return_name` also the name of that object, with `return_data` also a DistanceData, in
        which the mesh is called "__external".
        """
        world = self._with_single(mesh, transform)
        world.step(self._objs, self._single)
        found = world.scene.closest_pair(0, 1)
        return self._distance(world, self._single, found, lambda names: names[0], return_name, return_data)

    def min_distance_internal(
        self, name: Hashable | None = None, return_names: bool = False, return_data: bool = False
    ) -> Any:
        """Return the least signed distance of two objects of the manager, or of one and any other.

        With `return_names` also the sorted tuple of two names, with `return_data` also a
        DistanceData.
        """
        if name is None:
            world = self._internal()
            world.step(self._objs, self._objs)
            found = world.scene.closest_pair(0, 0)
        else:
            world = self._step_named(name)
            found = world.scene.closest_pair(0, 1)
        return self._distance(world, self._objs, found, _sorted, return_names, return_data)

    def min_distance_other(
        self, other_manager: CollisionManager, return_names: bool = False, return_data: bool = False
    ) -> Any:
        """Return the least signed distance of an object of this manager to an object of another.

        With `return_names` also the tuple of two names, first of this manager, then of the other;
        with `return_data` also a DistanceData.
        """
        world = self._with_other(other_manager)
        world.step(self._objs, other_manager._objs)
        found = world.scene.closest_pair(0, 1)
        return self._distance(world, other_manager._objs, found, lambda names: names, return_names, return_data)

    def _known(self, name: Hashable) -> _Object:
        if name not in self._objs:
            raise ValueError(f"{name} not in collision manager!")
        return self._objs[name]

    def _internal(self) -> _World:
        if self._internal_world is None:
            self._internal_world = _World(is_internal=True)
        return self._internal_world

    def _with_single(self, mesh: Any, transform: ArrayLike | None) -> _World:
        body = _body_of(mesh)
        known = self._single.get(_EXTERNAL)
        if known is not None and known.source is body:
            known.place(transform)
        else:
            self._single[_EXTERNAL] = _Object(body, transform, self._poses)
        if self._single_world is None:
            self._single_world = _World(is_internal=False)
        return self._single_world

    def _step_named(self, name: Hashable) -> _World:
        one = {name: self._known(name)}
        if self._named_world is None:
            self._named_world = _World(is_internal=False)
        self._named_world.step({other: each for other, each in self._objs.items() if other != name}, one)
        return self._named_world

    def _with_other(self, other: CollisionManager) -> _World:
        if not isinstance(other, CollisionManager):
            kind = f"{type(other).__module__}.{type(other).__name__}"
            raise TypeError(f"other_manager is a {kind} (expected lin_canny.trimesh.CollisionManager)")
        world = self._other_worlds.get(other)
        if world is None:
            world = self._other_worlds[other] = _World(is_internal=False)
        return world

    def _collisions(
        self, world: _World, others: dict[Hashable, _Object], shown: Any, return_names: bool, return_data: bool
    ) -> Any:
        if not (return_names or return_data) and world.still_touches(self._objs, others):
            return True
        world.step(self._objs, others)
        pairs = world.scene.pairs()
        hits = pairs[pairs["overlaps"] == 1]
        reported: list[Any] = [len(hits) > 0]
        if len(hits) > 0:
            world.last = world.named(int(hits[0]["a"]), int(hits[0]["b"]))[1:]
        if return_names or return_data:
            named = [world.named(int(hit["a"]), int(hit["b"]))[1:] for hit in hits]
            if return_names:
                reported.append({shown(names) for names in named})
            if return_data:
                reported.append([c for a, b in named for c in _contacts((a, b), (self._objs[a], others[b]))])
        return reported[0] if len(reported) == 1 else tuple(reported)

    def _distance(
        self,
        world: _World,
        others: dict[Hashable, _Object],
        found: Any,
        shown: Any,
        return_names: bool,
        return_data: bool,
    ) -> Any:
        distance, data = math.inf, None
        names: tuple[Hashable, Hashable] = (None, None)
        if found is not None:
            distance = found.distance
            is_exchanged, a, b = world.named(found.a, found.b)
            points = (found.point_b, found.point_a) if is_exchanged else (found.point_a, found.point_b)
            names = (a, b)
            data = DistanceData(names, (self._objs[a], others[b]), points, distance)
        reported: list[Any] = [distance]
        if return_names:
            reported.append(shown(names))
        if return_data:
            reported.append(data)
        return reported[0] if len(reported) == 1 else tuple(reported)


def scene_to_collision(scene: Any) -> tuple[CollisionManager, dict[Hashable, Geometry]]:
    """Return a manager of the meshes of a trimesh.Scene, and their geometries by node."""
    manager = CollisionManager()
    objects = {}
    for node in scene.graph.nodes_geometry:
        transform, geometry = scene.graph[node]
        objects[node] = manager.add_object(name=node, mesh=scene.geometry[geometry], transform=transform)
    return manager, objects
