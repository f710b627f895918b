import math
import pickle

import numpy as np
import pytest

import lin_canny as lc

BOX = lc.Geometry.box(0.5, 0.5, 0.5)
ONE = (0, 0, 0, 1)
CELL, ROBOT = 1, 2


def row_of_boxes():
    """Return a scene with a wall at x = 3, a body at x = 0, and their ids."""
    scene = lc.Scene()
    scene.set_queries(ROBOT, CELL, overlap=True, within=0.25, distance=math.inf, depth=True)
    wall = scene.insert(BOX, ((3, 0, 0), ONE), group=CELL, fixed=True)
    arm = scene.insert(BOX, group=ROBOT)
    return scene, wall, arm


def test_steps_and_events():
    scene, wall, arm = row_of_boxes()
    changes = []
    for k in range(9):
        scene.set_pose(arm, ((0.5 * k, 0, 0), ONE))
        scene.step()
        (pair,) = scene.pairs()
        assert {pair["a"], pair["b"]} == {wall, arm}
        x = abs(3 - 0.5 * k) - 1
        assert pair["lower"] <= x <= pair["upper"]
        assert (pair["overlaps"], pair["within"]) == (x <= 0, x <= 0.25)
        changes += [(k, change) for change, a, b in scene.events()]
    assert changes == [(4, "overlap began"), (4, "came within")] and len(scene) == 2
    assert repr(scene) == "<Scene: 2 bodies, 1 pairs>"
    scene.set_poses([arm], [[-1, 0, 0, *ONE]])
    scene.step()
    assert [e[0] for e in scene.events()] == ["left within", "overlap ended"]
    assert scene.pose(arm)[:3, 3].tolist() == [-1, 0, 0]


def test_searches():
    scene, wall, arm = row_of_boxes()
    far = scene.insert(BOX, ((9, 0, 0), ONE), group=CELL)
    scene.step()
    found = scene.closest_pair(ROBOT, CELL)
    assert (found.a, found.b, found.distance, found.state) == (arm, wall, 2, "separated")
    assert found.point_a[0] == 0.5 and found.point_b[0] == 2.5 and np.array_equal(found.normal, [1, 0, 0])
    assert [(p.a, p.b) for p in scene.pairs_within(ROBOT, CELL, 2)] == [(arm, wall)]
    assert [p.b for p in scene.nearest(arm, 5)] == [wall, far]
    scene.exclude_pair(arm, wall)
    scene.step()
    assert scene.closest_pair(ROBOT, CELL).b == far
    scene.include_pair(arm, wall)
    scene.remove(far)
    scene.step()
    assert scene.closest_pair(ROBOT, CELL).b == wall


def test_impacts_between_two_steps():
    scene = lc.Scene()
    scene.set_queries(0, 0, impact=1e-9)
    wall = scene.insert(lc.Geometry.box(0.01, 5, 5), fixed=True)
    bullet = scene.insert(lc.Geometry.ball(0.01), ((-50, 0, 0), ONE))
    scene.step()
    scene.set_velocity(bullet, (100, 0, 0), (0, 0, 0))
    scene.advance(1)
    scene.step()
    ((a, b, safe, hit, distance),) = scene.impacts()
    assert {a, b} == {wall, bullet} and safe < 0.4998 < hit and hit - safe < 1e-9 and distance == 0


def test_bodies_that_come_near_between_two_steps():
    scene = lc.Scene()
    scene.set_queries(0, 0, within=0.05, impact_within=0.05)
    block = scene.insert(lc.Geometry.box(0.5, 0.5, 0.5), fixed=True)
    ball = scene.insert(lc.Geometry.ball(0.1), ((-5, 0.63, 0), ONE))
    scene.step()
    scene.set_velocity(ball, (10, 0, 0), (0, 0, 0))
    scene.advance(1)
    scene.step()
    ((a, b, safe, hit, distance),) = scene.impacts()
    met = (5 - 0.5 - math.sqrt(0.15**2 - 0.13**2)) / 10
    assert not scene.events() and {a, b} == {block, ball}
    assert safe <= met + 1e-12 and met - 1e-12 <= hit and hit - safe < 1e-9 and distance == 0.05


def test_parts_of_an_assembly():
    scene = lc.Scene()
    plate = lc.Geometry.box(5, 40, 30)
    for x in (0, 9.5, 20):
        scene.insert(plate, ((x, 0, 0), ONE), fixed=True)
    scene.set_queries(0, 0, overlap=True)
    scene.step()
    assert not scene.events() and scene.fixed_left_out == 3
    scene.set_queries(0, 0, overlap=True, fixed=True)
    scene.step()
    assert [event[0] for event in scene.events()] == ["overlap began"] and scene.fixed_left_out == 0


def test_a_pickled_scene_goes_on_with_the_same_bits():
    scene, _, arm = row_of_boxes()
    scene.step()
    other = pickle.loads(pickle.dumps(scene))
    for each in (scene, other):
        each.set_pose(arm, ((1.7, 0.3, 0.2), (0.1, 0, 0, math.sqrt(0.99))))
        each.step()
    assert np.array_equal(scene.pairs(), other.pairs()) and scene.events() == other.events()


def test_refused_calls():
    scene, wall, arm = row_of_boxes()
    with pytest.raises(lc.SceneError, match="`Scene::step` first"):
        scene.closest_pair(ROBOT, CELL)
    scene.remove(arm)
    with pytest.raises(lc.SceneError, match="does not exist in this scene"):
        scene.set_pose(arm, None)
    with pytest.raises(lc.SceneError, match="does not exist in this scene"):
        scene.pose(arm)
    with pytest.raises(lc.SceneError, match="group is out of range: 32"):
        scene.insert(BOX, group=32)
    with pytest.raises(lc.SceneError, match="2 ids and 1 poses"):
        scene.set_poses([wall, wall], [[0, 0, 0, *ONE]])
    with pytest.raises(lc.SceneError, match="query distance -1 is out of range"):
        scene.set_queries(0, 0, within=-1)
    with pytest.raises(lc.SceneError, match="fixed"):
        scene.set_velocity(wall, (1, 0, 0), (0, 0, 0))
