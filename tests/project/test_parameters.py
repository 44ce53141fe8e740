"""Docstrings of everything public that takes three arguments or more: each has a section that tells
of them."""

import ast
import re
from functools import cache
from pathlib import Path

import contactsnes

PACKAGE = Path(contactsnes.__path__[0])
MANY = 3
"""Arguments from which on they are told one by one, ``self`` not counted."""


def arguments(function):
    """Names of a function's arguments, without those that stand for its object or class."""
    given = function.args
    several = [argument for argument in (given.vararg, given.kwarg) if argument]
    names = [argument.arg for argument in (*given.posonlyargs, *given.args, *given.kwonlyargs,
                                           *several)]
    return [name for name in names if name not in ("self", "cls")]


def public(node, prefix=""):
    """Public functions, methods and classes, with the arguments that they are called with."""
    for child in node.body:
        if not isinstance(child, (ast.FunctionDef, ast.ClassDef)) or child.name.startswith("_"):
            continue
        if isinstance(child, ast.FunctionDef):
            yield prefix + child.name, child, arguments(child)
            continue
        made = [inner for inner in child.body if getattr(inner, "name", "") == "__init__"]
        yield prefix + child.name, child, arguments(made[0]) if made else []
        yield from public(child, f"{prefix}{child.name}.")


def told(node):
    """Whether a docstring has the section."""
    return "Parameters\n----------\n" in (ast.get_docstring(node) or "")


def named(node):
    """Names that the section tells of: what stands before the colons of its lines."""
    section = ast.get_docstring(node).split("Parameters\n----------\n")[1]
    lines = re.split(r"\n\n|\n\w+\n-+\n", section)[0].splitlines()
    heads = [line.split(" : ")[0] for line in lines if not line.startswith(" ")]
    return {name.strip().lstrip("*") for head in heads for name in head.split(",")}


def above(name, nodes):
    """The methods that one of a class overrides, among nodes by their dotted names."""
    owner, _, method = name.rpartition(".")
    for node in nodes.get(owner, ()):
        for base in map(ast.unparse, node.bases):
            inherited = f"{base.rpartition('.')[2]}.{method}"
            yield from nodes.get(inherited, ())
            yield from above(inherited, nodes)


def lacking(trees):
    """Names of what has many arguments and no section on them, nor overrides what has one."""
    known = [entry for tree in trees for entry in public(tree)]
    nodes = {}
    for name, node, _ in known:
        nodes.setdefault(name, []).append(node)
    return [name for name, node, given in known
            if len(given) >= MANY and not any(map(told, [node, *above(name, nodes)]))]


def test_the_finder_of_arguments():
    tree = ast.parse("def one(a, b, *c): pass\nclass Two:\n def __init__(self, a, *, b): pass\n"
                     " def three(self, **a): pass\n def _four(self): pass\ndef _five(): pass")
    assert [(name, given) for name, _, given in public(tree)] == [
        ("one", ["a", "b", "c"]), ("Two", ["a", "b"]), ("Two.three", ["a"])]


def test_the_finder_of_sections():
    tree = ast.parse("class One:\n def run(self, a, b, c):\n  'Runs.\\n\\n  Parameters\\n"
                     "  ----------\\n  a, b, c : int'\n"
                     "class Two(rooms.One):\n def go(self, a, b, c): pass\n"
                     "class Three(Two):\n def run(self, a, b, c): pass\n"
                     "def run(a, b, c): pass")
    assert lacking([tree]) == ["Two.go", "run"]


@cache
def package():
    """The tree of every file, parsed once."""
    return [ast.parse(path.read_text(encoding="utf-8"), path)
            for path in sorted(PACKAGE.rglob("*.py"))]


def test_many_arguments_are_told_one_by_one():
    assert not lacking(package()), "these lack a section Parameters"


def test_sections_name_all_arguments_and_no_others():
    """Dataclasses, which have no ``__init__`` of their own, tell of their fields."""
    found = {name: set(given) ^ named(node) for tree in package()
             for name, node, given in public(tree) if given and told(node)}
    assert not {name: names - {"self", "cls"} for name, names in found.items()
                if names - {"self", "cls"}}
