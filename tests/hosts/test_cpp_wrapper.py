"""The C++ wrapper of `--to cmake`: the numbers of the C, no allocation, and lengths that the compiler checks."""

from __future__ import annotations

from pathlib import Path

import pytest
from host_models import PUSHED, prepared
from programs import program, run

import derive
from derive.export.cmake import cmake_files

pytestmark = pytest.mark.hosts

CALLS = """
#include "pushed.hpp"
#include <cstdio>

using model = tisserand::pushed_model;

template <class T> static void print(const char *name, const T &values)
{
    std::printf("%s", name);
    for (double x : values) std::printf(" %.17g", x);
    std::printf("\\n");
}

int main()
{
    model object;
    std::array<double, model::np> p;
    std::array<double, model::nq> q;
    double v[model::nv]; // an array of C is as good
    std::array<double, model::nv> vdot, h;
    std::array<double, model::nlambda> lambda;
    std::array<double, model::nout> out;
    std::array<double, model::nk + model::nu> k;
    model::defaults(p);
    p[PUSHED_P_EI] = 30.0;
    model::start(q, v);
    int code = int(object.setup(p));
    object.set_inputs(std::array<double, model::nu>{0.7});
    code |= int(object.solve(0.5, q, v, vdot, lambda)) | int(object.force(0.5, q, v, h));
    code |= int(object.outputs(0.5, q, v, vdot, lambda, out));
    object.constants(k);
    print("vdot", vdot), print("lambda", lambda), print("h", h), print("out", out), print("k", k);
    p[PUSHED_P_EI] = -1.0;
    std::printf("code %d\\n", code);
    std::printf("refused %d\\n", int(object.setup(p) == tisserand::status::not_finite));
    return 0;
}
"""


@pytest.fixture(scope="module")
def include(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wrapper")
    derive.write(cmake_files(prepared(PUSHED)), folder)
    run(program("gcc"), "-O2", "-ffp-contract=off", "-c", f"-I{folder}/include", folder / "src/pushed.c", cwd=folder)
    return folder


STRICT = ("-std=c++17", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-fno-exceptions", "-fno-rtti")


@pytest.mark.parametrize("compiler", ["g++", "clang++"])
def test_results_are_those_of_the_c_functions(compiler: str, include: Path, tmp_path: Path) -> None:
    (tmp_path / "calls.cpp").write_text(CALLS)
    flags = (f"-I{include}/include", "-O1")
    run(
        program(compiler),
        *STRICT,
        *flags,
        tmp_path / "calls.cpp",
        include / "pushed.o",
        "-lm",
        "-o",
        tmp_path / "calls",
    )
    said = {name: list(map(float, rest)) for name, *rest in map(str.split, run(tmp_path / "calls").splitlines())}
    model = prepared(PUSHED)
    native = derive.load_scene(model.files)
    k = native.with_inputs(native.setup(EI=30), [0.7])
    q, v = ([x.start for x in part] for part in (model.coordinates, model.velocities))
    vdot, lam = native.solve(0.5, q, v, k)
    assert said["code"] == [0] and said["refused"] == [1]
    assert said["vdot"] == vdot.tolist() and said["lambda"] == lam.tolist() and said["k"] == k.tolist()
    assert said["h"] == native.force(0.5, q, v, k).tolist()
    assert said["out"] == native.evaluate_outputs(0.5, q, v, vdot, lam, k).tolist()


def test_nothing_is_allocated_or_thrown(include: Path, tmp_path: Path) -> None:
    source = CALLS.replace("#include <cstdio>", "#include <cstdio>").replace("static void print", "void print")
    (tmp_path / "calls.cpp").write_text(source)
    run(
        program("g++"),
        "-std=c++17",
        "-fno-exceptions",
        f"-I{include}/include",
        "-c",
        tmp_path / "calls.cpp",
        cwd=tmp_path,
    )
    needed = {line.split()[-1] for line in run(program("nm"), "--undefined-only", tmp_path / "calls.o").splitlines()}
    functions = {name for name in needed if name.startswith("pushed_")}
    assert needed - functions <= {"printf", "putchar", "__stack_chk_fail", "_GLOBAL_OFFSET_TABLE_", "__dso_handle"}
    assert "pushed_solve" in functions


WRONG = {
    "length": ("std::array<double, model::nq> q;", "std::array<double, model::nq + 1> q;"),
    "ignored": ("int code = int(object.setup(p));", "int code = 0; object.setup(p);"),
    "const": ("std::array<double, model::nv> vdot, h;", "const std::array<double, model::nv> vdot{}, h{};"),
}


@pytest.mark.parametrize("fault", WRONG)
def test_the_compiler_refuses(fault: str, include: Path, tmp_path: Path) -> None:
    assert WRONG[fault][0] in CALLS
    (tmp_path / "calls.cpp").write_text(CALLS.replace(*WRONG[fault]))
    with pytest.raises(AssertionError, match=r"calls\.cpp:\d+:\d+: error"):
        run(program("g++"), *STRICT, "-fsyntax-only", f"-I{include}/include", tmp_path / "calls.cpp")
