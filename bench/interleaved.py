"""Time several ways to compute one thing in one process, one after the other again and again.

So whatever else the machine does meets all of them. Arrays come from files; the values of a way go to a file.
"""

from __future__ import annotations

import os
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from derive.runtime.compiler import compiler

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Way:
    """One way: C text that computes state s of `states` into `out`, of which `size` values are filled.

    A way whose text computes `together` states at once is called once for all of them.
    """

    name: str
    call: str
    size: int
    together: int = 1


MAIN = """\
#define _POSIX_C_SOURCE 199309L
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
%(declare)s

enum { WAYS = %(ways)d, STATES = %(states)d, REPEATS = %(repeats)d };
static double *out;

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double) t.tv_sec + (double) t.tv_nsec;
}

static double *array(size_t count)
{
    double *x = (double *) aligned_alloc(64, (count * sizeof(double) / 64 + 1) * 64);
    if (!x) exit(3);
    memset(x, 0, count * sizeof(double));
    return x;
}

static double *loaded(const char *path, size_t count)
{
    double *x = array(count);
    FILE *file = fopen(path, "rb");
    if (!file || fread(x, sizeof(double), count, file) != count) exit(4);
    fclose(file);
    return x;
}

%(data)s
%(functions)s
typedef void (*way)(int s);
static const way ways[] = {%(names)s};
static const int sizes[] = {%(sizes)s}, together[] = {%(together)s};

int main(void)
{
    out = array(%(most)d);
%(load)s
    for (int w = 0; w < WAYS; w++) {
        char path[64];
        sprintf(path, "values_%%d.bin", w);
        FILE *file = fopen(path, "wb");
        for (int s = 0; s < STATES; s += together[w]) {
            ways[w](s);
            fwrite(out, sizeof(double), (size_t) sizes[w], file);
        }
        fclose(file);
    }
    long passes[WAYS];
    for (int w = 0; w < WAYS; w++) {
        passes[w] = 1;
        for (;;) {
            const double start = now();
            for (long k = 0; k < passes[w]; k++) for (int s = 0; s < STATES; s += together[w]) ways[w](s);
            if (now() - start > %(least)g) break;
            passes[w] *= 2;
        }
    }
    for (int r = 0; r < REPEATS; r++)
        for (int w = 0; w < WAYS; w++) {
            const double start = now();
            for (long k = 0; k < passes[w]; k++) for (int s = 0; s < STATES; s += together[w]) ways[w](s);
            printf("%%.17g\\n", (now() - start) / (double) passes[w] / STATES);
        }
    return 0;
}
"""


def interleaved(
    ways: Sequence[Way],
    *,
    declare: str,
    once: str,
    arrays: Mapping[str, Array],
    scratch: Mapping[str, int],
    objects: Sequence[Path],
    folder: Path,
    states: int,
    repeats: int,
    libraries: Sequence[str] = (),
    least: float = 1e6,
) -> tuple[list[float], list[Array]]:
    """Median nanoseconds of a state, and values of each way; `least` are the nanoseconds of a repeat."""
    for name, values in arrays.items():
        np.ascontiguousarray(values, dtype=np.float64).tofile(folder / f"{name}.bin")
    names = [*arrays, *scratch]
    load = [f'    {name} = loaded("{name}.bin", {values.size});' for name, values in arrays.items()]
    load += [f"    {name} = array({size});" for name, size in scratch.items()]
    text = MAIN % {
        "declare": declare,
        "ways": len(ways),
        "states": states,
        "repeats": repeats,
        "data": "\n".join(f"static double *{name};" for name in names),
        "functions": "\n".join(f"static void way_{n}(int s) {{ {way.call} }}" for n, way in enumerate(ways)),
        "names": ", ".join(f"way_{n}" for n in range(len(ways))),
        "sizes": ", ".join(str(way.size) for way in ways),
        "together": ", ".join(str(way.together) for way in ways),
        "most": max(way.size for way in ways) + 8,
        "load": "\n".join([*load, f"    {once}"]),
        "least": least,
    }
    (folder / "main.c").write_text(text)
    program = folder / "program"
    command = [*compiler(), "-O1", "-w", "-o", program, folder / "main.c", *objects, *libraries, "-lm"]
    subprocess.run(list(map(str, command)), check=True)
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    run = [str(program.resolve())]
    done = subprocess.run(run, cwd=folder, env=environment, stdout=subprocess.PIPE, text=True, check=True)
    times = np.array(done.stdout.split(), dtype=float).reshape(repeats, len(ways))
    values = [np.fromfile(folder / f"values_{n}.bin").reshape(-1, way.size) for n, way in enumerate(ways)]
    return np.median(times, axis=0).tolist(), values
