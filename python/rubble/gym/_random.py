"""Random numbers that depend on nothing but their names."""
from __future__ import annotations

from typing import Any

import numpy as np

_STEP = np.uint64(0x9E3779B97F4A7C15)
_FIRST, _SECOND = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)


def _mixed(x: np.ndarray) -> np.ndarray:
    """The finalizer of SplitMix64."""
    x = (x ^ (x >> np.uint64(30))) * _FIRST
    x = (x ^ (x >> np.uint64(27))) * _SECOND
    return x ^ (x >> np.uint64(31))


def uniform(seed: int, worlds: Any, episodes: Any, count: int, low: float = -1,
            high: float = 1) -> np.ndarray:
    """Numbers from `low` to `high` of some episodes of some worlds.

    Number k of episode e of world w is a hash of (seed, w, e, k): it depends neither on the other worlds nor
    on when it is drawn.

    Args:
        worlds: (n,) numbers of worlds.
        episodes: (n,) the number of the episode of each.
    Returns:
        (n, count) doubles.
    """
    with np.errstate(over="ignore"):
        x = np.full(len(worlds), np.uint64(seed & 0xFFFFFFFFFFFFFFFF))
        for name in (np.asarray(worlds), np.asarray(episodes)):
            x = _mixed((x + _STEP) ^ _mixed(name.astype(np.uint64) + _STEP))
        x = _mixed(x[:, None] + _STEP * np.arange(1, count + 1, dtype=np.uint64))
    return low + (high - low) * ((x >> np.uint64(11)).astype(np.float64) / 2.0 ** 53)
