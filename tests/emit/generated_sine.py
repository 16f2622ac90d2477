"""The sine and cosine of the generated C, compiled alone."""

from __future__ import annotations

import ctypes
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from derive.rendering import render
from derive.runtime.compiler import FLAGS, compile_shared

FUNCTIONS = """
#include <float.h>
#include <math.h>
#include <string.h>
#define TISSERAND_RESTRICT restrict
#include <stddef.h>
%s
void singles(int n, const double *x, double *s, double *c)
{
    for (int i = 0; i < n; i++) {
        s[i] = tisserand_sin(x[i]);
        c[i] = tisserand_cos(x[i]);
    }
}
void ones(int n, const double *x, double *s, double *c)
{
    for (int i = 0; i < n; i++) tisserand_sines_of_one(x + i, s + i, c + i);
}
void blocks(int n, const double *x, double *s, double *c)
{
    for (; n >= 8; n -= 8, x += 8, s += 8, c += 8) tisserand_sines(8, x, s, c);
    if (n > 0) tisserand_sines(n, x, s, c);
}
void spaced(int n, const double *x, double *s, double *c)
{
    double room[2][40];
    tisserand_spaced_sines((n + 2) / 3, x, 3, room[0], room[1]);
    for (int i = 0; i < n; i++) s[i] = room[0][i / 3], c[i] = room[1][i / 3];
}
"""
PARTS = ("lanes", "instances", "states", "sine", "spaced_sines")


OPTIMISED = (*FLAGS, "-O2")
"""The flags that `derive.load` takes by default, which the compiler of the tests optimises if a level is added."""


@cache
def library(flags: tuple[str, ...] = OPTIMISED) -> ctypes.CDLL:
    with TemporaryDirectory() as folder:
        source = Path(folder) / "sine.c"
        source.write_text(FUNCTIONS % "\n".join(render(f"c/{part}.c.jinja", {}) for part in PARTS))
        return ctypes.CDLL(str(compile_shared([source], Path(folder) / "sine.so", flags)))


def sines(
    x: np.ndarray, function: str = "singles", flags: tuple[str, ...] = OPTIMISED
) -> tuple[np.ndarray, np.ndarray]:
    x = np.ascontiguousarray(x, dtype=float)
    s, c = np.empty_like(x), np.empty_like(x)
    getattr(library(flags), function)(len(x), *(ctypes.c_void_p(a.ctypes.data) for a in (x, s, c)))
    return s, c
