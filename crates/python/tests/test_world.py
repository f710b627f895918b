"""A checker whose world changes: each answer is that of a new checker of the same world."""

import math
import pickle

import numpy as np
import pytest

import lin_canny as lc

HERE = (0, 0, 0, 1)

# A column that turns about z and slides along z, with an arm that bends about y, a flange without
# bodies and two fingers.
ROBOT = """<robot name="picker">
  <link name="base"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
  <link name="column"/>
  <link name="arm">
    <collision><origin xyz="0.5 0 0"/><geometry><box size="1 0.1 0.1"/></geometry></collision>
  </link>
  <link name="wrist">
    <collision><origin xyz="0.15 0 0"/><geometry><sphere radius="0.06"/></geometry></collision>
  </link>
  <link name="flange"/>
  <link name="left"><collision><geometry><box size="0.1 0.02 0.04"/></geometry></collision></link>
  <link name="right"><collision><geometry><box size="0.1 0.02 0.04"/></geometry></collision></link>
  <joint name="lift" type="prismatic">
    <parent link="base"/><child link="column"/><axis xyz="0 0 1"/><limit lower="0" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="turn" type="revolute">
    <parent link="column"/><child link="arm"/><axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="1" velocity="1"/>
  </joint>
  <joint name="bend" type="revolute">
    <parent link="arm"/><child link="wrist"/><origin xyz="1 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="mount" type="fixed"><parent link="wrist"/><child link="flange"/><origin xyz="0.3 0 0"/></joint>
  <joint name="l" type="fixed"><parent link="flange"/><child link="left"/><origin xyz="0 0.05 0"/></joint>
  <joint name="r" type="fixed"><parent link="flange"/><child link="right"/><origin xyz="0 -0.05 0"/></joint>
</robot>
"""
LOW, HIGH = [0, -3, -2], [2, 3, 2]


@pytest.fixture
def robot(tmp_path):
    (tmp_path / "picker.urdf").write_text(ROBOT)
    return lc.Robot.load(tmp_path / "picker.urdf")


@pytest.fixture
def checker(robot):
    post = ("post", lc.Geometry.cylinder(half_height=1.5, radius=0.05), ((0.8, 0.8, 1), HERE))
    return lc.Checker(robot, obstacles=[post], exclude=[("base", "arm")])


def cloud(rng, count=200):
    return lc.Cloud(rng.uniform([-2, 1, 0], [2, 2, 2], (count, 3)), radius=0.03)


def answers(checker, q):
    """Return all answers of a checker as text that shows every digit, each by itself."""
    found = []
    for k, each in enumerate(q):
        checker.reset()
        near = checker.nearest(each, 0.2)
        found.append([(n.a, n.b, n.distance, n.lower, n.upper, n.excess, *n.normal, *n.gradient) for n in near])
        found.append((checker.in_contact(each), checker.is_free(each), checker.bodies, checker.excluded))
        checker.reset()
        found.append(repr(checker.certify(each, q[k - 1])))
    return repr(found)


def test_random_changes_equal_a_new_checker(checker):
    """Add, move, replace, remove, attach, detach, pad, exclude, set margins: 60 in a row."""
    rng = np.random.default_rng(1)
    q = rng.uniform(LOW, HIGH, (4, 3))
    shapes = [lc.Geometry.box(0.1, 0.2, 0.1), lc.Geometry.ball(0.1), cloud(rng), lc.Geometry.half_space([0, 0, 1], -0.2)]
    done = set()
    for step in range(60):
        obstacles = [i for i in checker.ids if i.kind == "obstacle"]
        attached = [i for i in checker.ids if i.kind == "attached"]
        any_body = checker.ids[rng.integers(len(checker.ids))]
        pose = (tuple(rng.uniform(-1, 2, 3)), HERE)
        match rng.integers(11):
            case 0 | 1:
                checker.add_obstacle(f"thing {step}", shapes[rng.integers(4)], pose)
                done.add("add")
            case 2 if obstacles:
                assert checker.move_obstacle(obstacles[0], pose) == [obstacles[0]]
                done.add("move")
            case 3 if obstacles:
                checker.replace_obstacle(obstacles[-1], shapes[rng.integers(3)])
                done.add("replace")
            case 4 if len(obstacles) > 2:
                checker.remove_obstacle(obstacles[1])
                done.add("remove")
            case 5 | 6:
                link = ["flange", "wrist", "arm"][rng.integers(3)]
                checker.attach(link, f"part {step}", shapes[rng.integers(3)], None, touch_links=["left", "flange"])
                done.add("attach")
            case 7 if attached:
                checker.detach(attached[0])
                done.add("detach")
            case 8 if attached:
                assert checker.detach_at(attached[0], q[0]).kind == "obstacle"
                done.add("detach_at")
            case 9:
                checker.pad(any_body, float(rng.uniform(0, 0.05)))
                done.add("pad")
            case 10:
                checker.exclude("wrist", any_body)
                checker.set_pair_margin("arm", any_body, float(rng.uniform(0, 0.05)))
                done.add("exclude")
        if step % 6 == 5:
            again = pickle.loads(pickle.dumps(checker))
            assert again.ids == checker.ids and answers(again, q) == answers(checker, q)
    assert len(done) == 9, done


def test_a_saved_world_equals_the_checker(robot, tmp_path):
    """In random cells, with paddings, margins and excluded pairs."""
    rng = np.random.default_rng(8)
    mesh = lc.Geometry.mesh([[0, 0, 0], [0.3, 0, 0], [0, 0.3, 0], [0, 0, 0.3]], [[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 2, 3]])
    solids = [lc.Geometry.box(0.1, 0.2, 0.3), lc.Geometry.ball(0.1), lc.Geometry.cylinder(half_height=0.2, radius=0.1)]
    shapes = [*solids, mesh, cloud(rng), lc.Geometry.half_space([0, 0.6, 0.8], -1)]
    q = rng.uniform(LOW, HIGH, (4, 3))
    for case in range(12):
        turned = rng.normal(size=4)
        place = (tuple(rng.uniform(-1, 1, 3)), tuple(turned / np.linalg.norm(turned)))
        # The file has the last word on adjacent links, which are excluded or not.
        checker = lc.Checker(robot, pose=place, margin=rng.uniform(0, 0.02), exclude_adjacent=case % 2 == 0)
        for k, shape in enumerate(shapes):
            checker.add_obstacle(f"thing {k}", shape, (tuple(rng.uniform(-1, 2, 3)), place[1]))
        checker.remove_obstacle(checker.ids[-2])
        checker.attach("flange", "part", solids[case % 3], (tuple(rng.uniform(0, 0.2, 3)), HERE), touch_links=["left"])
        checker.pad("part", rng.uniform(0, 0.05))
        checker.pad(checker.ids[-1], rng.uniform(0, 0.05))
        checker.exclude("wrist", checker.ids[-2])
        checker.set_pair_margin("arm", "thing 0", rng.uniform(0, 0.05))
        path = tmp_path / f"{case}.json"
        checker.save(path)
        again = lc.Checker(robot, pose=place, cell=path)
        assert again.margin == checker.margin and answers(again, q) == answers(checker, q)
        assert np.array_equal(again.clearances(q), checker.clearances(q))
        again.save(str(tmp_path / "again.json"))
        assert (tmp_path / "again.json").read_bytes() == path.read_bytes()
        assert answers(pickle.loads(pickle.dumps(again)), q) == answers(checker, q)
    assert lc.Checker(robot, cell=path, margin=0.5).margin == 0.5
    with pytest.raises(lc.FileError, match="none"):
        checker.save(tmp_path / "none" / "cell.json")


def test_points_without_a_return_are_dropped_or_refused(robot, tmp_path):
    (tmp_path / "scan.xyz").write_text("1 0 0\nnan nan nan\n0 1 1\n")
    cell = tmp_path / "cell.json"
    cell.write_text('{"bodies": [{"name": "scan", "cloud": {"file": "scan.xyz", "radius": 0.1}}]}')
    checker = lc.Checker(robot, cell=cell)
    assert "scan" in checker.bodies and any("scan.xyz" in text and "1 " in text for text in checker.skipped)
    with pytest.raises(lc.FileError, match="scan.xyz.*2"):
        lc.Checker(robot, cell=cell, keep_invalid=True)
    (tmp_path / "scan.xyz").write_text("1 0 0\n0 1 1\n")
    again = pickle.loads(pickle.dumps(lc.Checker(robot, cell=cell, keep_invalid=True)))
    assert again.skipped == [] and again.bodies == checker.bodies


def test_obstacles_come_and_go(checker):
    q = [0.5, 0.0, 0.0]

    def gap():
        """Return the least distance to a wall."""
        return next((n for n in checker.nearest(q, 10) if n.b == "wall"), None)

    assert gap() is None
    wall = checker.add_obstacle("wall", lc.Geometry.box(0.1, 2, 2), ((2, 0, 0), HERE))
    assert repr(wall) == "<BodyId obstacle 1>" and checker.bodies[-1] == "wall" and checker.ids[-1] == wall
    # The tips of the fingers are at 1.35, the wall is from 1.9 on.
    assert gap().distance == pytest.approx(0.55, abs=1e-12) and gap().ids[1] == wall
    assert gap().a in ("left", "right") and abs(gap().normal @ [1, 0, 0]) == pytest.approx(1)
    checker.move_obstacle("wall", ((1.5, 0, 0), HERE))
    assert gap().distance == pytest.approx(0.05, abs=1e-12)
    checker.replace_obstacle(wall, lc.Cloud([[0, 0, 0.5], [0, 5, 0]], radius=0.1))
    # From the edges of the fingers at y = 0.04.
    assert gap().distance == pytest.approx(math.hypot(0.15, 0.04) - 0.1, abs=1e-12)
    assert checker.remove_obstacle("wall") == [wall] and gap() is None
    with pytest.raises(lc.PlanError, match="obstacle 1 was removed"):
        checker.remove_obstacle(wall)
    assert checker.add_obstacle("wall", lc.Geometry.ball(1), ((9, 0, 0), HERE)).index == 2


def test_an_attached_object_moves_with_its_link(checker):
    part = lc.Geometry.box(0.05, 0.03, 0.2)
    assert checker.attach("flange", "part", part, ((0, 0, -0.1), HERE), touch_links=["left", "right"]).kind == "attached"
    assert ("left", "part") in checker.excluded
    wall = checker.add_obstacle("wall", lc.Geometry.half_space([-1, 0, 0], -2))
    assert checker.required_distance(checker.ids[0], wall) == 0
    rng = np.random.default_rng(3)
    for q in rng.uniform(LOW, HIGH, (50, 3)):
        pose = checker.link_pose("flange", q) @ np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, -0.1], [0, 0, 0, 1]])
        part_id = next(i for i in checker.ids if i.kind == "attached")
        assert np.allclose(checker.pose(part_id, q), pose, atol=1e-12)
        corners = np.array([[x, y, z] for x in (-0.05, 0.05) for y in (-0.03, 0.03) for z in (-0.2, 0.2)])
        by_hand = 2 - (corners @ pose[:3, :3].T + pose[:3, 3])[:, 0].max()
        near = [n for n in checker.nearest(q, 100) if (n.a, n.b) == ("part", "wall")]
        assert near[0].distance == pytest.approx(by_hand, abs=1e-9)
    left = checker.detach_at("part", q)
    assert left.kind == "obstacle" and np.allclose(checker.pose(left, q), pose, atol=1e-12)
    assert "part" in checker.bodies and not any(i.kind == "attached" for i in checker.ids)


def test_paddings_and_margins_of_pairs(checker):
    q = [0.5, 0.0, 0.0]
    near = checker.clearance(q)
    post = checker.ids[-1]
    checker.margin = 0.01
    checker.pad("post", 0.02)
    checker.pad(["left", "right", "flange"], 0.005)
    kept = {n.a: n.distance - n.excess for n in checker.nearest(q, 10) if n.b == "post"}
    assert kept["wrist"] == pytest.approx(0.03) and kept["left"] == pytest.approx(0.035)
    assert checker.padding(post) == 0.02 and checker.clearance(q).distance == near.distance
    assert checker.set_pair_margin("wrist", post, 0.5) == [("wrist", "post")]
    assert checker.required_distance(near.ids[0], post) > 0
    found = next(n for n in checker.nearest(q, 10) if (n.a, n.b) == ("wrist", "post"))
    assert found.distance - found.excess == pytest.approx(0.52) and checker.is_free(q) == (found.distance > 0.52)
    checker.set_pair_margin("wrist", "post", None)
    found = next(n for n in checker.nearest(q, 10) if (n.a, n.b) == ("wrist", "post"))
    assert found.distance - found.excess == pytest.approx(0.03)


def test_a_verdict_says_what_a_pair_must_keep(checker):
    q = [0.5, math.pi / 4, 0.0]
    near = checker.clearance([0.5, 0.0, 0.0])
    blocked = [
        (lambda: checker.pad("post", 0.01), 0.01, "(padding of post)"),
        (lambda: setattr(checker, "margin", 0.02), 0.03, "(margin 0.02 + padding of post 0.01)"),
        (lambda: checker.set_pair_margin("wrist", "post", 0.5), 0.51, "(margin of the pair 0.5 + padding of post 0.01)"),
    ]
    for change, distance, origin in blocked:
        change()
        verdict = checker.certify([0.5, 0, 0], q)
        assert verdict.pair == ("wrist", "post") and verdict.required_distance == pytest.approx(distance)
        for text in (str(verdict), repr(verdict)):
            assert f"come within {distance} {origin}" in text and "meet" not in text
    assert checker.certify([0.5, 0, 0], [0.5, 0, 0]).required_distance in (None, verdict.required_distance)
    assert near.distance == checker.clearance([0.5, 0.0, 0.0]).distance


def test_the_padding_of_a_link_covers_what_it_carries(checker):
    post = checker.ids[-1]
    part = checker.attach("flange", "part", lc.Geometry.ball(0.05), ((0.1, 0, 0), HERE), touch_links=["left", "right"])
    late = checker.attach("wrist", "late", lc.Geometry.ball(0.05), ((0.1, 0, 0), HERE))
    checker.pad("wrist", 0.02)
    assert checker.padding(late) == 0.02 and checker.required_distance(late, post) == 0.02
    assert checker.padding(part) == 0
    checker.pad("late", 0)
    assert checker.required_distance(late, post) == 0
    checker.pad("late", 0.01)
    assert checker.required_distance(late, post) == 0.01
    checker.pad("late", None)
    assert checker.required_distance(late, post) == 0.02
    assert checker.padding(checker.detach_at("late", [0.5, 0, 0])) == 0


def test_excluded_pairs(checker):
    q = [0.5, math.pi / 4, 0.0]
    assert checker.in_contact(q) == [("wrist", "post")] and not checker.is_free(q)
    verdict = checker.certify([0.5, 0, 0], q)
    assert verdict.pair[1] == "post" and str(verdict).startswith(
        f"blocked by {verdict.pair[0]} and post, which meet at "
    )
    assert " meet between " in repr(verdict) and verdict.required_distance == 0
    taken = checker.exclude(["arm", "wrist", "left", "right"], "post")
    assert ("wrist", "post") in taken and checker.in_contact(q) == [] and checker.is_free(q)
    assert ("post", "wrist") in checker.excluded and ("arm", "base") in checker.excluded
    assert len(checker.excluded_ids) >= len(checker.excluded)
    assert checker.exclude("wrist", "post") == []
    assert checker.include("wrist", "post") == [("wrist", "post")]
    assert checker.in_contact(q) == [("wrist", "post")]


def test_gradients_are_derivatives_by_the_coordinates(checker):
    """Central differences agree to 1e-6 where the closest places are unique."""
    rng = np.random.default_rng(5)
    checker.add_obstacle("egg", lc.Geometry.ellipsoid(0.1, 0.2, 0.3), ((1.2, -0.5, 1), HERE))
    checker.add_obstacle("floor", lc.Geometry.half_space([0.1, 0.2, 1], -0.3))
    checker.add_obstacle("scan", lc.Cloud(rng.uniform([-2, 1, 0], [2, 2, 2], (30, 3)), radius=0.03))
    checker.attach("flange", "part", lc.Geometry.ball(0.05), ((0.1, 0, 0), HERE), touch_links=["left", "right"])
    step, compared, jumps = 1e-5, 0, 0
    for q in rng.uniform(np.add(LOW, 0.01), np.subtract(HIGH, 0.01), (150, 3)):
        for near in checker.nearest(q, 0.5):
            if near.distance < 1e-3:
                continue

            def pair(q, ids=near.ids):
                return next(n for n in checker.nearest(q, 5.0) if n.ids == ids)

            ends = [[pair(q + s * step * np.eye(3)[k]) for s in (-1, 1)] for k in range(3)]
            # Where the witness jumps or slides along a parallel face or edge, the distance has a kink.
            spread = max(np.abs(np.subtract(a.gradient, b.gradient)).max() for a, b in ends)
            if spread > 1e-3:
                jumps += 1
                continue
            by_hand = np.array([(b.distance - a.distance) / (2 * step) for a, b in ends])
            assert np.abs(near.gradient - by_hand).max() < 1e-6, (q, near)
            compared += 1
    assert compared > 200 and jumps < compared / 4, (compared, jumps)
    assert checker.scales.shape == (3,) and checker.scales[0] == 1 and np.all(checker.scales > 0)


def test_a_batch_of_closest_pairs_is_the_loop_bit_for_bit(checker):
    rng = np.random.default_rng(6)
    checker.add_obstacle("scan", cloud(rng), None)
    checker.attach("flange", "part", lc.Geometry.box(0.05, 0.05, 0.1), ((0.1, 0, 0), HERE), touch_links=["left"])
    checker.pad("part", 0.01)
    q = rng.uniform(LOW, HIGH, (300, 3))
    for k, slack in ((3, math.inf), (5, 0.1), (1, 0.0), (40, math.inf)):
        found = checker.nearest_batch(q, k, slack)
        assert found.shape == (300, k) and found["gradient"].shape == (300, k, 3)
        assert np.array_equal(found, checker.nearest_batch(q, k, slack, threads=3))
        for each, row in zip(q[:60], found, strict=False):
            checker.reset()
            near = checker.nearest(each, slack)[:k]
            count = int((row["a"] >= 0).sum())
            assert count == len(near) and np.all(row["distance"][count:] == np.inf)
            for n, entry in zip(near, row, strict=False):
                assert (n.a, n.b) == (checker.bodies[entry["a"]], checker.bodies[entry["b"]])
                assert n.ids == (checker.ids[entry["a"]], checker.ids[entry["b"]])
                for name in ("distance", "lower", "upper", "excess"):
                    assert getattr(n, name) == entry[name]
                for name in ("point_a", "point_b", "normal", "gradient"):
                    assert np.array_equal(getattr(n, name), entry[name])
    calls = []
    checker.nearest_batch(np.tile(q, (8, 1)), 1, progress=lambda *a: calls.append(a))
    assert calls == [(1024, 2400), (2048, 2400), (2400, 2400)]
    assert checker.nearest_batch(np.zeros((0, 3)), 2).shape == (0, 2)
    assert checker.nearest_batch(q, 0).shape == (300, 0)
    for many in (2**40, 2**63):
        with pytest.raises(lc.PlanError, match="number of entries of a batch is out of range"):
            checker.nearest_batch(q, many)


@pytest.mark.parametrize(("batch", "arguments"), [("nearest_batch", [1, 0.0]), ("clearances", []), ("are_free", [])])
@pytest.mark.parametrize("threads", [1, 2, 3])
@pytest.mark.parametrize("row", [3, 1500, 2047, 2300])
def test_the_configuration_that_is_refused_is_named(checker, batch, arguments, threads, row):
    """In every part of a batch, and in the share of every thread of a part."""
    q = np.tile(np.random.default_rng(6).uniform(LOW, HIGH, (50, 3)), (48, 1))
    q[row, 1] = 4
    with pytest.raises(lc.PlanError, match=f"^configuration {row}: coordinate 1, turn, is 4"):
        getattr(checker, batch)(q, *arguments, threads=threads)


def test_batches_see_the_changed_world(checker):
    rng = np.random.default_rng(7)
    checker.add_obstacle("first", lc.Geometry.ball(0.1), ((5, 5, 5), HERE))
    checker.add_obstacle("scan", cloud(rng), None)
    checker.remove_obstacle("first")
    checker.attach("flange", "part", lc.Geometry.box(0.05, 0.05, 0.1), ((0.1, 0, 0), HERE), touch_links=["left", "right"])
    checker.pad("scan", 0.05)
    q = rng.uniform(LOW, HIGH, (1500, 3))
    found = checker.clearances(q)
    assert np.array_equal(found, checker.clearances(q, threads=2))
    for k in range(0, 1500):
        if k % 1024 == 0:  # each block begins with a new checker
            checker.reset()
        near = checker.clearance(q[k])
        assert (near.distance, near.lower, near.upper) == tuple(found[k][["distance", "lower", "upper"]])
        assert near.ids == (checker.ids[found["a"][k]], checker.ids[found["b"][k]])
    free = checker.are_free(q)
    assert free.tolist() == [checker.is_free(each) for each in q] and 0 < free.sum() < 1500


def test_a_lift_starts_in_contact(checker):
    part, table = lc.Geometry.box(0.0625, 0.0625, 0.0625), lc.Geometry.box(0.125, 0.25, 0.125)
    table = checker.add_obstacle("table", table, ((1.25, 0, 0.3125), HERE))
    checker.attach("flange", "part", part, None, touch_links=["left", "right"])
    taken, lifted, pressed = [0.5, 0.0, 0.0], [1.0, 0.1, 0.0], [0.49, 0.0, 0.0]
    assert checker.in_contact(taken) == [("part", "table")]
    assert checker.certify(taken, lifted).state == "blocked"
    checker.start_contact_margin = 1e-3
    verdict = checker.certify(taken, lifted)
    assert verdict.is_free and len(verdict.start_contacts) == 1 and checker.is_free(taken, lifted)
    leaving = verdict.start_contacts[0]
    assert leaving.pair == ("part", "table") and 0 < leaving.until < 1 and "part" in repr(leaving)
    assert abs(leaving.distance) < 1e-12 and leaving.kept <= leaving.distance and "part and table" in str(verdict)
    path = checker.certify_path([taken, lifted, [1.0, 0.5, 0.0]])
    assert path.is_free and [c.pair for c in path.start_contacts] == [("part", "table")]
    assert checker.certify(taken, pressed).pair == ("part", "table")
    blocked = checker.certify_path([taken, lifted, pressed])
    assert blocked.state == "blocked" and [c.pair for c in blocked.start_contacts] == [("part", "table")]
    assert str(blocked).endswith("leaving the contact of part and table")
    slid = checker.certify(taken, [0.5, 0.05, 0.0])
    assert slid.is_free and slid.start_contacts[0].until is None
    checker.remove_obstacle(table)
    assert checker.certify(taken, lifted).start_contacts == []
    checker.start_contact_margin = None
    assert checker.start_contact_margin is None
    with pytest.raises(lc.PlanError, match="start contact margin is out of range: -1"):
        checker.start_contact_margin = -1


def test_a_cast_starts_in_contact():
    table, part = lc.Geometry.box(1, 1, 0.1), lc.Geometry.box(0.1, 0.1, 0.1)
    options = {"duration": 1, "tolerance": 1e-9}

    def cast(velocity, **more):
        v = (velocity, (0, 0, 0))
        return lc.PairTracker().cast(table, part, None, ((0, 0, 0.2), HERE), velocity_b=v, **options, **more)

    assert cast((0.1, 0, 1)).state == "start"
    lift = cast((0.1, 0, 1), start_contact_margin=1e-3)
    assert lift.state == "miss" and 0 < lift.start_contact.until < 0.02 and lift.start_contact.pair is None
    assert cast((0.1, 0, 0), start_contact_margin=1e-3).start_contact.until is None
    press = cast((0, 0, -0.01), start_contact_margin=1e-3)
    assert press.state == "hit" and press.hit < 1e-6
    with pytest.raises(lc.MotionError, match="start contact margin"):
        cast((0, 0, 1), start_contact_margin=math.nan)


def test_ids_are_values():
    a, b = lc.BodyId("obstacle", 3), lc.BodyId("obstacle", 3)
    assert a == b and hash(a) == hash(b) and a != lc.BodyId("robot", 3) and a != "obstacle 3"
    assert pickle.loads(pickle.dumps(a)) == a and (a.kind, a.index) == ("obstacle", 3)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda c: c.move_obstacle("pst", None), '"pst" does not exist .nearest: "post"'),
        (lambda c: c.remove_obstacle("arm"), "arm is not an obstacle"),
        (lambda c: c.detach("post"), "post is not an attached object"),
        (lambda c: c.detach_at("post", [0, 0, 0]), "post is not an attached object"),
        (lambda c: c.attach("flage", "x", lc.Geometry.ball(1)), '"flage" does not exist .nearest: "flange"'),
        (lambda c: c.attach("flange", "x", lc.Geometry.half_space([0, 0, 1])), '"x" is a half-space'),
        (lambda c: c.pad("post", -1), "padding is out of range: -1"),
        (lambda c: c.pad("flange", 1), '"flange" has no bodies'),
        (lambda c: c.set_pair_margin("arm", "post", math.nan), "margin of a pair"),
        (lambda c: c.exclude("arm", "moon"), '"moon" does not exist'),
        (lambda c: c.exclude("arm", "arm"), '"arm" has no pair with itself'),
        (lambda c: c.nearest([0, 0, 0], -1), "slack of the distances is out of range: -1"),
        (lambda c: c.nearest_batch(np.zeros((2, 3)), 1, slack=-1), "slack of the distances is out of range: -1"),
        (lambda c: c.clearance(np.ma.masked_equal([0.0, 1, 0], 1)), "a configuration: the mask covers 1 entries"),
        (lambda c: c.include(lc.BodyId("obstacle", 9), "arm"), "obstacle 9 does not exist"),
        (lambda c: c.add_obstacle("x", lc.Geometry.ball(1), np.eye(4) * 1.0 + np.diag([0, 0, 0, 1.0])), "last row"),
        (lambda c: c.padding(lc.BodyId("attached", 0)), "attached object 0 does not exist"),
        (lambda c: c.required_distance(c.ids[-1], c.ids[-1]), "not a pair"),
        (lambda c: c.pose(c.ids[0], [0, 0]), r"2 numbers \(expected 3\)"),
        (lambda c: c.link_pose("hand", [0, 0, 0]), '"hand" does not exist'),
        (lambda c: c.nearest_batch([[0, 0, 0], [0, 4, 0]], 1), "configuration 1: coordinate 1"),
        (lambda c: c.nearest_batch(np.zeros((2, 2)), 1), r"expected \(N, 3\)"),
        (lambda c: c.nearest_batch(np.zeros((2, 3)), 1, threads=0), "threads is 0"),
        (lambda c: lc.BodyId("link", 0), '"link"'),
    ],
)
def test_refused_changes(checker, call, words):
    before = (checker.bodies, checker.excluded, checker.ids)
    with pytest.raises(lc.LinCannyError, match=words):
        call(checker)
    assert before == (checker.bodies, checker.excluded, checker.ids)
