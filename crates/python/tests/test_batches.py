import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import lin_canny as lc

BOX = lc.Geometry.box(1, 1, 1)


def poses(count, seed=0, spread=3.0):
    """Return random poses, shape (count, 7)."""
    rng = np.random.default_rng(seed)
    q = rng.normal(size=(count, 4))
    q /= np.linalg.norm(q, axis=1)[:, None]
    return np.hstack([rng.normal(size=(count, 3)) * spread, q])


def matrices(seven):
    x, y, z, w = seven[:, 3:].T
    m = np.zeros((len(seven), 4, 4))
    m[:, 0, :3] = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], 1)
    m[:, 1, :3] = np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], 1)
    m[:, 2, :3] = np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], 1)
    m[:, :3, 3], m[:, 3, 3] = seven[:, :3], 1
    return m


@given(st.integers(0, 130), st.integers(0, 2**32 - 1))
@settings(max_examples=40, deadline=None)
def test_a_batch_is_the_single_calls(count, seed):
    at = poses(count, seed)
    found = lc.distances(BOX, BOX, at)
    assert found.shape == (count,) and found.dtype.names == ("distance", "lower", "upper")
    assert np.all(found["lower"] <= found["distance"]) and np.all(found["distance"] <= found["upper"])
    by_matrix = lc.distances(BOX, BOX, matrices(at))
    assert np.allclose(by_matrix["distance"], found["distance"], atol=1e-12)
    for pose, row in zip(at, found):
        single = lc.PairTracker().closest(BOX, BOX, None, pose)
        assert single.lower <= row["upper"] and row["lower"] <= single.upper


@pytest.mark.parametrize("other", [BOX, lc.Geometry.ball(1), lc.Geometry.mesh(BOX.vertices, BOX.triangles)])
def test_bits_do_not_depend_on_threads(other):
    at = poses(5000)
    one = lc.distances(BOX, other, at)
    assert np.array_equal(one, lc.distances(BOX, other, at, threads=3))
    assert np.any(one["distance"] > 0) and np.any(one["distance"] <= 0)
    # Blocks of 1024 poses start afresh.
    assert np.array_equal(one[2048:], lc.distances(BOX, other, at[2048:]))


MESH = lc.Geometry.mesh(BOX.vertices, BOX.triangles)


def by_loop(query, at):
    """Return the answers of single calls, with a new tracker every 1024 poses."""
    for k, pose in enumerate(at):
        if k % 1024 == 0:
            tracker = lc.PairTracker()
        yield query(tracker, pose)


@pytest.mark.parametrize("other", [BOX, lc.Geometry.capsule(half_length=1, radius=0.4), MESH])
def test_closest_points_are_those_of_the_loop(other):
    at = poses(2500, 1, 1.0)
    found = lc.closest_batch(MESH if other is MESH else BOX, other, at)
    first = MESH if other is MESH else BOX
    assert found.tobytes() == lc.closest_batch(first, other, at, threads=3).tobytes()
    loop = by_loop(lambda tracker, pose: tracker.closest(first, other, None, pose), at)
    for row, one in zip(found, loop, strict=True):
        for name in ("distance", "lower", "upper", "state", "features"):
            assert row[name] == getattr(one, name)
        for name in ("parts", "point_a", "point_b", "normal", "gradient_a", "gradient_b"):
            assert np.array_equal(row[name], getattr(one, name))
    assert {"separated", "overlapping"} <= set(found["state"])
    assert found[["distance", "lower", "upper"]].tolist() == lc.distances(first, other, at).tolist()


def test_a_pair_for_each_pose_is_the_loop():
    kinds = [BOX, MESH, lc.Geometry.ball(0.8), lc.Geometry.capsule(half_length=1, radius=0.4)]
    rng = np.random.default_rng(4)
    count = 1500
    at = poses(count, 5, 1.2)
    first, second = ([kinds[k] for k in rng.integers(0, 4, count)] for _ in range(2))
    pairs = list(zip(first, second, strict=True))

    def loop(query):
        for k, ((a, b), pose) in enumerate(zip(pairs, at, strict=True)):
            if k % 1024 == 0:
                tracker = lc.PairTracker()
            yield query(tracker, a, b, pose)

    found = lc.closest_batch(first, second, at)
    assert found.tobytes() == lc.closest_batch(first, tuple(second), at, threads=2).tobytes()
    for row, one in zip(found, loop(lambda t, a, b, pose: t.closest(a, b, None, pose)), strict=True):
        assert (row["distance"], row["lower"], row["upper"]) == (one.distance, one.lower, one.upper)
        assert np.array_equal(row["point_b"], one.point_b) and np.array_equal(row["gradient_b"], one.gradient_b)
    near = lc.distances(first, second, at)
    for row, one in zip(near, loop(lambda t, a, b, pose: t.closest(a, b, None, pose)), strict=True):
        assert row.tolist() == (one.distance, one.lower, one.upper)
    contacts, start = lc.contacts_batch(first, second, at, prediction=0.1)
    for k, one in enumerate(loop(lambda t, a, b, pose: t.contacts(a, b, None, pose, prediction=0.1))):
        assert contacts[start[k] : start[k + 1]].tobytes() == one.tobytes()
    depths = lc.penetration_batch(first, second[0], at[:count])
    assert depths.shape == (count,)
    # One geometry for all, and one for each.
    assert lc.distances(BOX, second, at).tobytes() == lc.distances([BOX] * count, second, at).tobytes()


def test_refused_pairs_of_batches():
    at = poses(3)
    for call in (lc.distances, lc.closest_batch, lc.contacts_batch, lc.penetration_batch):
        with pytest.raises(lc.PairError, match=r"b: there are 2 geometries \(expected one, or one for each of 3 poses"):
            call(BOX, [BOX, BOX], at)
        with pytest.raises(lc.PairError, match=r"a: entry 1 is a str \(expected a Geometry\)"):
            call([BOX, "box", BOX], BOX, at)
        with pytest.raises(lc.PairError, match=r"a is a int \(expected a Geometry, or one for each pose\)"):
            call(3, BOX, at)


@pytest.mark.parametrize("geometry", [BOX, MESH, lc.Geometry.capsule(half_length=1, radius=0.4)])
def test_batches_of_points_are_the_single_calls(geometry):
    points = np.random.default_rng(8).uniform(-2, 2, (400, 3))
    columns = [*lc.signed_distance(geometry, points, bounds=True), lc.contains(geometry, points)]
    columns += lc.closest_points(geometry, points)
    for k, point in enumerate(points):
        one = [*lc.signed_distance(geometry, point[None], bounds=True), lc.contains(geometry, point[None])]
        one += lc.closest_points(geometry, point[None])
        for all_of_them, alone in zip(columns, one, strict=True):
            assert np.array_equal(all_of_them[k], alone[0])


@pytest.mark.parametrize("other", [BOX, MESH])
def test_contacts_and_depths_are_those_of_the_loop(other):
    at = poses(1500, 2, 0.7)
    contacts, first = lc.contacts_batch(BOX, other, at, prediction=0.2, max_points=3)
    again = lc.contacts_batch(BOX, other, at, prediction=0.2, max_points=3, threads=2)
    assert contacts.tobytes() == again[0].tobytes() and np.array_equal(first, again[1])
    assert first.shape == (1501,) and first[0] == 0 and first[-1] == len(contacts) > 1500
    loop = by_loop(lambda t, pose: t.contacts(BOX, other, None, pose, prediction=0.2, max_points=3), at)
    for start, end, one in zip(first[:-1], first[1:], loop, strict=True):
        assert contacts[start:end].tobytes() == one.tobytes() and contacts.dtype == one.dtype
    depths = lc.penetration_batch(BOX, other, at)
    assert depths.tobytes() == lc.penetration_batch(BOX, other, at, threads=2).tobytes()
    loop = by_loop(lambda tracker, pose: tracker.penetration(BOX, other, None, pose), at)
    for row, one in zip(depths, loop, strict=True):
        assert (row["lower"], row["upper"]) == (one.lower, one.upper)
        assert np.array_equal(row["shift"], one.shift)


def test_narrow_depths_are_those_of_the_loop():
    u = lc.Geometry.pieces([(BOX, ((x, 0, 0), (0, 0, 0, 1))) for x in (-1.5, 1.5)])
    at = poses(12, 9, 0.1)
    depths = lc.penetration_batch(u, BOX, at, tolerance=0.2, budget=3000)
    tracker = lc.PairTracker()
    assert depths.tobytes() == lc.penetration_batch(u, BOX, at, tolerance=0.2, budget=3000, threads=2).tobytes()
    for pose, row, wide in zip(at, depths, lc.penetration_batch(u, BOX, at), strict=True):
        one = tracker.penetration(u, BOX, None, pose, tolerance=0.2, budget=3000)
        assert (one.lower, one.upper) == (row["lower"], row["upper"]) and one.upper - one.lower <= 0.2
        assert wide["lower"] <= one.lower and one.upper <= wide["upper"]


def test_faults_of_batches_of_poses():
    at = poses(3000)
    at[2345, 3:] = 0
    for call in (lc.closest_batch, lc.contacts_batch, lc.penetration_batch):
        for threads in (1, 2):
            with pytest.raises(lc.PoseError, match="pose 2345: quaternion"):
                call(BOX, BOX, at, threads=threads)
        assert len(call(BOX, BOX, at[:0])) in (0, 2)
    with pytest.raises(lc.LinCannyError, match="max_points is 9"):
        lc.contacts_batch(BOX, BOX, at, max_points=9)
    with pytest.raises(lc.LinCannyError, match=r"tolerance is NaN \(expected at least 0\)"):
        lc.penetration_batch(BOX, BOX, at, tolerance=np.nan)
    triangle = lc.Geometry.mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    assert np.isnan(lc.penetration_batch(BOX, triangle, at[:2])["shift"]).all()


@pytest.mark.skipif(os.name != "posix", reason="needs signals of POSIX")
@pytest.mark.parametrize("call", [lc.closest_batch, lc.contacts_batch, lc.penetration_batch])
def test_ctrl_c_ends_a_batch_of_poses(call):
    calls = []
    timer = threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT))
    at = poses(1_000_000, 3, 0.5)

    def report(done, total):
        if not calls:
            timer.start()
        calls.append((done, total))

    with pytest.raises(KeyboardInterrupt):
        call(MESH, MESH, at, progress=report)
    assert calls[-1][0] < calls[-1][1] == len(at)


def test_forms_of_poses():
    at = poses(100)
    expected = lc.distances(BOX, BOX, at)
    forms = [
        (at[:, :3], at[:, 3:]),
        np.asfortranarray(at),
        np.repeat(at, 2, axis=0)[::2],
        at.tolist(),
    ]
    for form in forms:
        assert np.array_equal(lc.distances(BOX, BOX, form), expected)
    m = matrices(at)
    expected = lc.distances(BOX, BOX, m)
    assert np.array_equal(lc.distances(BOX, BOX, np.asfortranarray(m)), expected)
    single = lc.distances(BOX, BOX, m.astype(np.float32))
    assert np.allclose(single["distance"], expected["distance"], atol=1e-4)


@pytest.mark.parametrize("threads", [1, 2])
def test_the_pose_that_is_refused_is_named(threads):
    at = poses(3000)
    at[2007, 3:] *= 2
    with pytest.raises(lc.PoseError, match="pose 2007: quaternion .* squared norm is [34]"):
        lc.distances(BOX, BOX, at, threads=threads)
    m = matrices(poses(9))
    m[7, 0, 3] = np.inf
    with pytest.raises(lc.PoseError, match="pose 7: translation of B"):
        lc.distances(BOX, BOX, m)
    with pytest.raises(lc.PoseError, match=r"shape is \(9, 3, 3\)"):
        lc.distances(BOX, BOX, m[:, :3, :3])
    with pytest.raises(lc.LinCannyError, match="threads is 0"):
        lc.distances(BOX, BOX, m, threads=0)


def test_progress_and_exceptions_of_the_callable():
    told = []
    lc.distances(BOX, BOX, poses(3000), progress=lambda done, total: told.append((done, total)))
    assert told[-1] == (3000, 3000) and told == sorted(told)
    with pytest.raises(ZeroDivisionError):
        lc.distances(BOX, BOX, poses(9), progress=lambda done, total: 1 / 0)


def test_a_bar_of_tqdm(capfd):
    pytest.importorskip("tqdm", reason="tqdm is not installed")
    lc.distances(BOX, BOX, poses(3000), progress=True)
    assert "3000/3000" in capfd.readouterr().err


@pytest.mark.skipif(os.name != "posix", reason="needs signals of POSIX")
@pytest.mark.parametrize("threads", [1, 2])
def test_ctrl_c_ends_a_batch(threads):
    ring = lc.Geometry.hull(np.random.default_rng(1).normal(size=(500, 3)))
    at = np.tile(poses(10_000, spread=0.5), (200, 1))  # minutes of work
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    start = time.perf_counter()
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        lc.distances(ring, ring, at, threads=threads)
    assert time.perf_counter() - start < 5


FEW_THREADS = """
import resource, sys
import numpy as np
import lin_canny as lc
box = lc.Geometry.box(1, 1, 1)
at = np.tile([1.5, 0, 0, 0, 0, 0, 1], (100 * 1024, 1))
one = lc.distances(box, box, at)
pages = int(open("/proc/self/statm").read().split()[0])
# Of 100 stacks of 2 MiB a few fit.
most = pages * resource.getpagesize() + (60 << 20)
resource.setrlimit(resource.RLIMIT_AS, (most, most))
assert np.array_equal(lc.distances(box, box, at, threads=100), one)
"""


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="needs the memory of the process from /proc")
def test_a_batch_ends_if_the_system_starts_few_threads():
    done = subprocess.run([sys.executable, "-c", FEW_THREADS], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_other_threads_run_during_a_batch():
    hull = lc.Geometry.hull(np.random.default_rng(1).normal(size=(100, 3)))
    at, ticks, stop = np.tile(poses(10_000, spread=1), (4, 1)), [0], threading.Event()

    def tick():
        while not stop.is_set():
            ticks[0] += 1
            time.sleep(0.001)

    ticker = threading.Thread(target=tick)
    ticker.start()
    before = ticks[0]
    lc.distances(hull, hull, at)
    during = ticks[0] - before
    stop.set()
    ticker.join()
    assert during > 5
