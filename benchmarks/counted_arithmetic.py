"""Floating-point operations of a compiled kernel, counted by its Python with numbers that count."""

from __future__ import annotations

import importlib
import importlib.util
import math
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from types import ModuleType, SimpleNamespace

import numpy as np

from missionkit import jit


class Tally:
    """How many operations were made."""

    def __init__(self) -> None:
        self.operations = 0


def _arithmetic(operation: Callable[[float, float], float]) -> Callable:
    def method(self, other):
        if isinstance(other, np.ndarray):
            return NotImplemented  # numpy then does it number by number
        self.tally.operations += 1
        return Counted(operation(self.value, float(other)), self.tally)

    return method


class Counted:
    """A float whose additions, multiplications, divisions and roots are counted."""

    __slots__ = ("tally", "value")

    def __init__(self, value: float, tally: Tally) -> None:
        self.value = float(value)
        self.tally = tally

    __add__ = __radd__ = _arithmetic(lambda a, b: a + b)
    __mul__ = __rmul__ = _arithmetic(lambda a, b: a * b)
    __sub__, __rsub__ = _arithmetic(lambda a, b: a - b), _arithmetic(lambda a, b: b - a)
    __truediv__, __rtruediv__ = _arithmetic(lambda a, b: a / b), _arithmetic(lambda a, b: b / a)

    def __neg__(self):
        return Counted(-self.value, self.tally)

    def __abs__(self):
        return Counted(abs(self.value), self.tally)

    def __float__(self):
        return self.value

    def __eq__(self, other):
        return self.value == float(other)

    def __lt__(self, other):
        return self.value < float(other)

    def __le__(self, other):
        return self.value <= float(other)

    def __gt__(self, other):
        return self.value > float(other)

    def __ge__(self, other):
        return self.value >= float(other)

    __hash__ = None


def counting(values, tally: Tally):
    """Return an array of counted numbers."""
    return np.vectorize(lambda v: Counted(v, tally), otypes=[object])(np.asarray(values, float))


@contextmanager
def plain(names: Sequence[str], tally: Tally) -> Iterator[list[ModuleType]]:
    """Load modules afresh, in this order, uncompiled and with arithmetic that counts.

    Args:
        names: full names; each may import those before it.
        tally: what is counted.
    """
    kept, compiled = dict(sys.modules), jit.compiled
    jit.compiled = lambda function: function
    try:
        yield [_fresh(name, tally) for name in names]
    finally:
        jit.compiled = compiled
        for name in names:
            sys.modules[name] = kept[name]


def _fresh(name: str, tally: Tally) -> ModuleType:
    importlib.import_module(name)
    spec = importlib.util.find_spec(name)
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    module.np, module.math, module.float = _arrays(tally), _functions(tally), lambda v: v
    for key, thing in list(vars(module).items()):
        if getattr(thing, "__module__", "") == "missionkit.geometry" and callable(thing):
            setattr(module, key, getattr(sys.modules["missionkit.geometry"], key, thing))
    return module


def _arrays(tally: Tally) -> SimpleNamespace:
    def made(make: Callable) -> Callable:
        return lambda *shape: counting(make(*shape), tally)

    return SimpleNamespace(
        zeros=made(np.zeros), empty=made(np.zeros), eye=made(np.eye), array=np.array
    )


def _functions(tally: Tally) -> SimpleNamespace:
    def counted(function: Callable[[float], float]) -> Callable:
        def call(v):
            tally.operations += 1
            return Counted(function(float(v)), tally)

        return call

    return SimpleNamespace(
        inf=math.inf, sqrt=counted(math.sqrt), sin=counted(math.sin), cos=counted(math.cos)
    )
