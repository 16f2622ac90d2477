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
    classes = exception_classes()
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
