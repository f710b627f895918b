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


def test_pairs_of_links_have_boxes(checker):
    q = np.random.default_rng(5).uniform(*checker.limits.T, (3000, 2))
    curves = np.stack([q, np.roll(q, 1, axis=0)], axis=1)[:200]
    are_free, verdicts = checker.are_free(q), checker.certify_batch(curves)
    calls = []
    pairs = checker.prepare_pairs(boxes=200, progress=lambda *done: calls.append(done))
    assert pairs and calls
    for a, b, atlas in pairs:
        assert isinstance(a, str) and isinstance(b, str) and 0 < atlas.searched <= 200
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
