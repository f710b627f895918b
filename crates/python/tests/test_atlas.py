import numpy as np
import pytest

import lin_canny as lc
from test_robot import checker, robot  # noqa: F401 (fixtures)


def test_boxes_say_what_the_checker_says(checker, tmp_path):
    atlas = checker.free_boxes(boxes=500)
    free, contact, left = atlas.shares
    assert free > 0.5 and contact > 0 and free + contact + left == pytest.approx(1, abs=1e-12)
    assert atlas.range.tolist() == checker.limits.tolist() and "free" in repr(atlas)
    q = np.random.default_rng(3).uniform(*checker.limits.T, (2000, 2))
    verdicts = atlas.verdicts(q)
    is_free = checker.are_free(q)
    assert verdicts.dtype == np.int8 and (verdicts[verdicts != 0] == np.where(is_free, 1, -1)[verdicts != 0]).all()
    for row, verdict in zip(q[:20], verdicts):
        assert atlas.verdict_at(row) == {1: "free", -1: "contact", 0: None}[verdict]
    assert np.mean(verdicts == 1) == pytest.approx(free, abs=0.05)

    calls = []
    part = checker.free_boxes(boxes=200, progress=lambda *done: calls.append(done))
    whole = checker.free_boxes(boxes=300, resume=part)
    assert whole.shares == atlas.shares and whole.searched == atlas.searched and calls
    atlas.save(tmp_path / "atlas.json")
    read = lc.Atlas.load(tmp_path / "atlas.json")
    assert read.shares == atlas.shares and (read.verdicts(q) == verdicts).all()
    checker.set_atlas(read)
    assert checker.has_atlas


def test_batches_answer_by_the_atlas(checker):
    q = np.random.default_rng(4).uniform(*checker.limits.T, (3000, 2))
    curves = np.stack([q, np.roll(q, 1, axis=0)], axis=1)[:200]
    are_free, verdicts = checker.are_free(q), checker.certify_batch(curves)
    checker.set_atlas(checker.free_boxes(boxes=500))
    for threads in (1, 3):
        assert (checker.are_free(q, threads=threads) == are_free).all()
        assert checker.certify_batch(curves, threads=threads).tobytes() == verdicts.tobytes()
    assert checker.has_atlas


def rails(tmp_path):
    """Three blocks on one rail, of which neighbours never count."""
    links = "".join(
        f'<link name="l{k}"><collision><geometry><box size="0.5 0.5 0.5"/></geometry></collision></link>'
        for k in range(3)
    )
    joints = "".join(
        f'<joint name="j{k}" type="prismatic"><parent link="l{k}"/><child link="l{k + 1}"/><axis xyz="1 0 0"/>'
        '<limit lower="0" upper="2" effort="1" velocity="1"/></joint>'
        for k in range(2)
    )
    (tmp_path / "rails.urdf").write_text(f'<robot name="rails">{links}{joints}</robot>')
    return lc.Checker(lc.Robot.load(tmp_path / "rails.urdf"))


def test_pairs_of_links_have_boxes(tmp_path):
    checker = rails(tmp_path)
    q = np.random.default_rng(5).uniform(0, 1, (3000, 2))
    curves = np.stack([q, np.roll(q, 1, axis=0)], axis=1)[:200]
    are_free, verdicts = checker.are_free(q), checker.certify_batch(curves)
    assert 0 < are_free.sum() < len(q)
    calls = []
    [(a, b, atlas)] = checker.prepare_pairs(boxes=200, progress=lambda *done: calls.append(done))
    assert (a, b) == ("l0", "l2") and 0 < atlas.searched <= 200 and calls
    assert atlas.shares[0] > 0.9
    for threads in (1, 3):
        assert (checker.are_free(q, threads=threads) == are_free).all()
        assert checker.certify_batch(curves, threads=threads).tobytes() == verdicts.tobytes()


def test_a_change_of_the_world_drops_the_atlas(checker):
    atlas = checker.free_boxes(boxes=50)
    checker.set_atlas(atlas)
    checker.margin = 0.01
    assert not checker.has_atlas
    with pytest.raises(lc.PlanError, match="does not belong to this checker: .*the margin differ"):
        checker.set_atlas(atlas)
    checker.set_atlas(None)
    with pytest.raises(lc.PlanError, match=r"configuration has 3 numbers \(expected 2\)"):
        atlas.verdict_at([0, 0, 0])


def test_a_damaged_file_is_an_error(checker, tmp_path):
    path = tmp_path / "atlas.json"
    checker.free_boxes(boxes=50).save(path)
    path.write_text(path.read_text().replace('"version":1', '"version":7'))
    with pytest.raises(lc.FileError, match="version 7"):
        lc.Atlas.load(path)
