"""Every exception class of the package derives from TisserandError, which the command line prints."""

import inspect
import pkgutil
from importlib import import_module

import derive
from derive.cli import main
from derive.errors import TisserandError


def exception_classes() -> set[type[BaseException]]:
    found: set[type[BaseException]] = set()
    for module in pkgutil.walk_packages(derive.__path__, "derive."):
        if module.name == "derive.__main__":
            continue
        for _, value in inspect.getmembers(import_module(module.name), inspect.isclass):
            if issubclass(value, BaseException) and value.__module__.startswith("derive."):
                found.add(value)
    return found


def test_every_exception_class_of_the_package_derives_from_one():
    classes = [c for c in exception_classes() if not issubclass(c, Warning)]
    assert len(classes) > 20
    assert [c for c in classes if not issubclass(c, TisserandError)] == []
    assert derive.TisserandError is TisserandError


def test_the_command_line_prints_any_of_them_and_ends_with_2(monkeypatch, capsys):
    class Failed(TisserandError):
        pass

    def run(options):
        raise Failed("block.npz: the file is empty; write it anew")

    monkeypatch.setattr("derive.cli.schema.run", run)
    assert main.main(["schema"]) == 2
    assert capsys.readouterr().err == "block.npz: the file is empty; write it anew\n"


def test_control_characters_of_a_specification_do_not_reach_the_terminal(tmp_path, capsys):
    """Names appear in paths and in texts: in lists of markers, in suggestions, in advice."""
    spec = tmp_path / "hostile.toml"
    spec.write_text(
        'name = "hostile"\n[ground.markers]\no = [0, 0]\n"b\\u001b[2J" = [1, 0]\n'
        '[bodies.rod]\nmass = 1\ninertia = 1\n[bodies.rod.markers]\n"a\\u001b[31m\\u202e" = [0, 0]\n'
        '[joints.pin]\nkind = "revolute"\nbetween = ["ground.c\\u001b[0m", "rod.zz\\u0007"]\n'
    )
    assert main.main(["build", str(spec)]) == 2
    output = capsys.readouterr().err
    assert output.count("\n") >= 4
    assert all(line.isprintable() for line in output.splitlines()), output


def test_control_characters_of_other_errors_are_shown_as_text(monkeypatch, capsys):
    class Failed(TisserandError):
        pass

    def run(options):
        raise Failed("the name a\x1b[31m\nis unknown")

    monkeypatch.setattr("derive.cli.schema.run", run)
    assert main.main(["schema"]) == 2
    assert capsys.readouterr().err == "the name a\\x1b[31m\nis unknown\n"
