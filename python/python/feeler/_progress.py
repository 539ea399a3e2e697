"""Progress of long calls, by tqdm where it is installed."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def progress_bar(
    progress: bool | Callable[[float], None], unit: str, total: float | None = None
) -> Iterator[Callable[[float], None] | None]:
    """What a long call calls with how far it is; nothing if nobody wants to know."""
    if not progress:
        yield None
    elif callable(progress):
        yield progress
    else:
        try:
            from tqdm.auto import tqdm
        except ImportError:
            yield _lines(unit, total)
            return
        with tqdm(total=total, unit=f" {unit}") as bar:

            def show(done: float) -> None:
                bar.n = round(done, 2)
                bar.refresh()

            yield show


def _lines(unit: str, total: float | None) -> Callable[[float], None]:
    of = "" if total is None else f" of {total:g}"

    def show(done: float) -> None:
        sys.stderr.write(f"\r{done:.1f}{of} {unit}")
        sys.stderr.flush()

    return show
