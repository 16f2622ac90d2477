"""Units free what they allocate, also where there is no memory, and stay within it: a program of C calls them."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path

import pytest
from fmus import VERSIONS, model_of, unit
from programs import program, run

from derive.export.fmi.variables import fmi_variables

pytestmark = pytest.mark.hosts

COUNTED = """
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "fmi{version}.h"

void *__real_calloc(size_t n, size_t size);
void *__real_malloc(size_t size);
void __real_free(void *p);
static int living, made, failing;
static void *counted(void *p) {{ living += p != 0; return p; }}
void *__wrap_calloc(size_t n, size_t size) {{ return made++ == failing ? 0 : counted(__real_calloc(n, size)); }}
void *__wrap_malloc(size_t size) {{ return made++ == failing ? 0 : counted(__real_malloc(size)); }}
void __wrap_free(void *p) {{ living -= p != 0; __real_free(p); }}

enum {{ ALL = {all}, NX = {nx}, KNOWNS = {knowns}, UNKNOWNS = {unknowns} }};
static unsigned refs[ALL];
static double values[ALL], seeds[ALL], x[NX];
"""

CALLS = {
    2: """
void *fmi2Instantiate(const char *, int, const char *, const char *, const fmi2CallbackFunctions *, int, int);
void fmi2FreeInstance(void *);
int fmi2SetupExperiment(void *, int, double, double, int, double);
int fmi2EnterInitializationMode(void *), fmi2ExitInitializationMode(void *), fmi2EnterContinuousTimeMode(void *);
int fmi2GetReal(void *, const unsigned *, size_t, double *), fmi2GetContinuousStates(void *, double *, size_t);
int fmi2SetContinuousStates(void *, const double *, size_t), fmi2GetDerivatives(void *, double *, size_t);
int fmi2GetNominalsOfContinuousStates(void *, double *, size_t), fmi2NewDiscreteStates(void *, fmi2EventInfo *);
int fmi2CompletedIntegratorStep(void *, int, int *, int *), fmi2DoStep(void *, double, double, int);
int fmi2GetDirectionalDerivative(void *, const unsigned *, size_t, const unsigned *, size_t, const double *, double *);
int fmi2GetFMUstate(void *, void **), fmi2SetFMUstate(void *, void *), fmi2FreeFMUstate(void *, void **);
int fmi2SerializedFMUstateSize(void *, void *, size_t *), fmi2SerializeFMUstate(void *, void *, char *, size_t);
int fmi2DeSerializeFMUstate(void *, const char *, size_t, void **), fmi2Reset(void *), fmi2Terminate(void *);
static char bytes[1 << 20];

static void *instance(int exchange, const char *token)
{
    return fmi2Instantiate("unit", exchange ? fmi2ModelExchange : fmi2CoSimulation, token, 0, 0, 0, 0);
}
static int begin(void *c)
{
    return fmi2SetupExperiment(c, 0, 0, 0, 0, 0) + fmi2EnterInitializationMode(c);
}
static int derivatives(void *c, int more) /* the states are knowns in a simulation, else unknowns */
{
    const unsigned *knowns = refs + 1, *unknowns = knowns + KNOWNS + more;
    const size_t known = KNOWNS + more, unknown = NX - more + UNKNOWNS;
    return fmi2GetReal(c, refs, ALL, values)
           + fmi2GetDirectionalDerivative(c, unknowns, unknown, knowns, known, seeds, values);
}
static int begun(void *c) { return fmi2ExitInitializationMode(c); }
static int event(void *c)
{
    fmi2EventInfo info;
    return fmi2NewDiscreteStates(c, &info) + fmi2EnterContinuousTimeMode(c);
}
static int states(void *c)
{
    int a, b;
    return fmi2GetContinuousStates(c, x, NX) + fmi2SetContinuousStates(c, x, NX) + fmi2GetDerivatives(c, x, NX)
           + fmi2GetNominalsOfContinuousStates(c, x, NX) + fmi2CompletedIntegratorStep(c, 1, &a, &b);
}
static int step(void *c) { return fmi2DoStep(c, 0, 0.01, 1); }
static int stored(void *c)
{
    void *state = 0, *copy = 0;
    size_t size = 0;
    int code = fmi2GetFMUstate(c, &state);
    code += code ? 0 : fmi2SerializedFMUstateSize(c, state, &size) + fmi2SerializeFMUstate(c, state, bytes, size);
    code += code ? 0 : fmi2DeSerializeFMUstate(c, bytes, size, &copy);
    code += code ? 0 : fmi2SetFMUstate(c, copy);
    return code + fmi2FreeFMUstate(c, &state) + fmi2FreeFMUstate(c, &copy);
}
static int end(void *c) { return fmi2Terminate(c) + fmi2Reset(c); }
#define FREE fmi2FreeInstance
""",
    3: """
void *fmi3InstantiateModelExchange(const char *, const char *, const char *, bool, bool, void *, void *);
void *fmi3InstantiateCoSimulation(const char *, const char *, const char *, bool, bool, bool, bool, const unsigned *,
                                  size_t, void *, void *, void *);
void fmi3FreeInstance(void *);
int fmi3EnterInitializationMode(void *, bool, double, double, bool, double), fmi3ExitInitializationMode(void *);
int fmi3EnterContinuousTimeMode(void *), fmi3GetFloat64(void *, const unsigned *, size_t, double *, size_t);
int fmi3GetContinuousStates(void *, double *, size_t), fmi3SetContinuousStates(void *, const double *, size_t);
int fmi3GetContinuousStateDerivatives(void *, double *, size_t), fmi3Terminate(void *), fmi3Reset(void *);
int fmi3GetNominalsOfContinuousStates(void *, double *, size_t);
int fmi3CompletedIntegratorStep(void *, bool, bool *, bool *);
int fmi3UpdateDiscreteStates(void *, bool *, bool *, bool *, bool *, bool *, double *);
int fmi3DoStep(void *, double, double, bool, bool *, bool *, bool *, double *);
int fmi3GetDirectionalDerivative(void *, const unsigned *, size_t, const unsigned *, size_t, const double *, size_t,
                                 double *, size_t);
int fmi3GetAdjointDerivative(void *, const unsigned *, size_t, const unsigned *, size_t, const double *, size_t,
                             double *, size_t);
int fmi3GetFMUState(void *, void **), fmi3SetFMUState(void *, void *), fmi3FreeFMUState(void *, void **);
int fmi3SerializedFMUStateSize(void *, void *, size_t *);
int fmi3SerializeFMUState(void *, void *, unsigned char *, size_t);
int fmi3DeserializeFMUState(void *, const unsigned char *, size_t, void **);
static unsigned char bytes[1 << 20];

static void *instance(int exchange, const char *token)
{
    return exchange ? fmi3InstantiateModelExchange("unit", token, 0, 0, 0, 0, 0)
                    : fmi3InstantiateCoSimulation("unit", token, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0);
}
static int begin(void *c) { return fmi3EnterInitializationMode(c, 0, 0, 0, 0, 0); }
static int derivatives(void *c, int more) /* the states are knowns in a simulation, else unknowns */
{
    const unsigned *knowns = refs + 1, *unknowns = knowns + KNOWNS + more;
    const size_t known = KNOWNS + more, unknown = NX - more + UNKNOWNS;
    return fmi3GetFloat64(c, refs, ALL, values, ALL)
           + fmi3GetDirectionalDerivative(c, unknowns, unknown, knowns, known, seeds, known, values, unknown)
           + fmi3GetAdjointDerivative(c, unknowns, unknown, knowns, known, seeds, unknown, values, known);
}
static int begun(void *c) { return fmi3ExitInitializationMode(c); }
static int event(void *c)
{
    bool a, b, d, e, f;
    double next;
    return fmi3UpdateDiscreteStates(c, &a, &b, &d, &e, &f, &next) + fmi3EnterContinuousTimeMode(c);
}
static int states(void *c)
{
    bool a, b;
    return fmi3GetContinuousStates(c, x, NX) + fmi3SetContinuousStates(c, x, NX)
           + fmi3GetContinuousStateDerivatives(c, x, NX) + fmi3GetNominalsOfContinuousStates(c, x, NX)
           + fmi3CompletedIntegratorStep(c, 1, &a, &b);
}
static int step(void *c)
{
    bool a, b, d;
    double last;
    return fmi3DoStep(c, 0, 0.01, 1, &a, &b, &d, &last);
}
static int stored(void *c)
{
    void *state = 0, *copy = 0;
    size_t size = 0;
    int code = fmi3GetFMUState(c, &state);
    code += code ? 0 : fmi3SerializedFMUStateSize(c, state, &size) + fmi3SerializeFMUState(c, state, bytes, size);
    code += code ? 0 : fmi3DeserializeFMUState(c, bytes, size, &copy);
    code += code ? 0 : fmi3SetFMUState(c, copy);
    return code + fmi3FreeFMUState(c, &state) + fmi3FreeFMUState(c, &copy);
}
static int end(void *c) { return fmi3Terminate(c) + fmi3Reset(c); }
#define FREE fmi3FreeInstance
""",
}

MAIN = """
extern const char fmu_token[];

/* A simulation; the sum of the codes, or -1 without an instance */
static int simulation(int exchange)
{
    void *c = instance(exchange, fmu_token);
    int code = -1;
    if (c) {
        code = begin(c) + derivatives(c, 0) + begun(c) + (exchange ? event(c) + states(c) : step(c));
        code += derivatives(c, NX) + stored(c) + end(c);
    }
    FREE(c);
    return code;
}

int main(void)
{
    for (unsigned i = 0; i < ALL; i++) {
        refs[i] = i;
        seeds[i] = 1.0 + i;
    }
    for (int exchange = 0; exchange < 2; exchange++) {
        made = 0;
        failing = -1;
        if (simulation(exchange) != 0 || living != 0) {
            return printf("failed: %d living\\n", living), 1;
        }
        const int count = made;
        if (instance(exchange, "of another unit") != 0 || living != 0) {
            return printf("a wrong token: %d living\\n", living), 1;
        }
        for (int i = 0; i < count; i++) {
            made = 0;
            failing = i;
            if (simulation(exchange) == 0 || living != 0) {
                return printf("without allocation %d: %d living\\n", i, living), 1;
            }
        }
        printf("%d allocations\\n", count);
    }
    return 0;
}
"""


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("name", ["linkage", "block"])
def test_no_memory_is_lost_or_overrun(name: str, version: int, tmp_path: Path) -> None:
    """The sanitizers of gcc check it, while each allocation fails in turn."""
    model = model_of(name)
    with zipfile.ZipFile(unit(model, version, tmp_path)) as archive:
        archive.extractall(tmp_path)
    nx = len(model.states)
    numbers = {
        "version": version,
        "all": len(fmi_variables(model)),
        "nx": nx,
        "knowns": len(model.inputs) + len(model.parameters),
        "unknowns": nx + len(model.outputs),
    }
    (tmp_path / "program.c").write_text(COUNTED.format(**numbers) + CALLS[version] + MAIN)
    sources = sorted((tmp_path / "sources").glob("*.c"))
    wrapped = ",".join(f"--wrap={function}" for function in ("calloc", "malloc", "free"))
    flags = ("-std=gnu99", "-O0", "-fsanitize=address,undefined", "-fno-sanitize-recover=all", f"-Wl,{wrapped}")
    run(
        program("gcc"),
        *flags,
        f"-I{tmp_path / 'sources'}",
        tmp_path / "program.c",
        *sources,
        "-o",
        tmp_path / "program",
        "-lm",
    )
    assert run(tmp_path / "program") == "5 allocations\n" * 2  # three of an instance, two stored states


@pytest.mark.parametrize("version", VERSIONS)
def test_instances_share_no_variables(version: int, tmp_path: Path) -> None:
    """Threads can have an instance each: the sources have constants and functions alone."""
    with zipfile.ZipFile(unit(model_of("pushed"), version, tmp_path)) as archive:
        archive.extractall(tmp_path)
    sources = sorted((tmp_path / "sources").glob("*.c"))
    run(program("gcc"), "-std=c99", "-O0", "-fno-pic", "-fcommon", "-c", *sources, cwd=tmp_path)
    symbols = run(program("nm"), *sorted(tmp_path.glob("*.o")))
    kinds = set(re.findall(r"^[0-9a-f ]{16} (\w) \w+$", symbols, re.M))
    assert kinds == {"T", "t", "R", "r", "U"}
