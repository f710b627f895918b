import numpy as np

import lin_canny as lc


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
    [(a, b, share)] = checker.prepare_pairs(boxes=200, progress=lambda *done: calls.append(done))
    assert (a, b) == ("l0", "l2") and 0.9 < share < 1 and 0 < len(calls) <= 200
    for threads in (1, 3):
        assert (checker.are_free(q, threads=threads) == are_free).all()
        assert checker.certify_batch(curves, threads=threads).tobytes() == verdicts.tobytes()
