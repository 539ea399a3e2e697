"""Progress bars of long calls, using tqdm if installed."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tqdm import tqdm


@contextmanager
def progress_bar(
    progress: bool | Callable[[float], None], unit: str, total: float | None = None
) -> Iterator[Callable[[float], None] | None]:
    """Yields the function that a long call reports its progress to, or ``None`` if ``progress`` is false."""
    if not progress:
        yield None
    elif callable(progress):
        yield progress
    else:
        try:
            tqdm = _tqdm()
        except ImportError:
            yield _lines(unit, total)
            return
        with tqdm(total=total, unit=f" {unit}") as bar:

            def show(done: float) -> None:
                bar.n = round(done, 2)
                # Lets tqdm limit the redraw rate.
                bar.update(0)

            yield show


def _tqdm() -> type[tqdm[Any]]:
    """Returns tqdm's class for notebooks or terminals. Suppresses its warning about missing notebook widgets."""
    from tqdm import TqdmWarning

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", TqdmWarning)
        from tqdm.auto import tqdm
    return tqdm


def _lines(unit: str, total: float | None) -> Callable[[float], None]:
    of = "" if total is None else f" of {total:g}"

    def show(done: float) -> None:
        sys.stderr.write(f"\r{done:.1f}{of} {unit}")
        sys.stderr.flush()

    return show
