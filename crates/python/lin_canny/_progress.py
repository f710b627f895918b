"""Progress of batches: a callable of the caller, or a bar of tqdm."""

from collections.abc import Callable
from typing import Any


def reporter(progress: Any, total: int) -> Callable[[int, int], object] | None:
    """Return the callable that a batch tells the number of queries done and of all."""
    if progress is None or progress is False:
        return None
    if progress is not True:
        return progress  # type: ignore[no-any-return]
    try:
        from tqdm.auto import tqdm
    except ImportError as error:
        raise ImportError("progress=True needs the package tqdm; a callable needs nothing") from error
    bar = tqdm(total=total)

    def report(done: int, total: int) -> None:
        if total != bar.total or done < bar.n:  # the next stage
            bar.reset(total)
        bar.update(done - bar.n)
        if done == total:
            bar.close()

    return report
