import subprocess
import sys

import pytest

import lin_canny as lc


def test_the_stubs_agree_with_the_module():
    pytest.importorskip("mypy", reason="mypy is not installed")
    if hasattr(lc._native, "_rust_loop"):
        pytest.skip("the module was built with the feature bench")
    command = [sys.executable, "-m", "mypy.stubtest", "lin_canny._native"]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr


def public_members():
    for name in lc.__all__:
        item = getattr(lc, name)
        yield name, item
        if isinstance(item, type) and not issubclass(item, Exception):
            yield from ((f"{name}.{k}", v) for k, v in vars(item).items() if not k.startswith("_"))


@pytest.mark.parametrize(("name", "item"), list(public_members()))
def test_everything_has_a_docstring(name, item):
    assert item.__doc__ and item.__doc__.strip(), name
