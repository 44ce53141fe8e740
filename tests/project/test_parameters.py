"""Docstrings of everything public that takes three arguments or more: each has a section that tells
of them."""

import ast
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


def above(name, classes):
    """The methods that one of a class overrides, as far as classes of these names are known."""
    owner, _, method = name.rpartition(".")
    for node in classes.get(owner, ()):
        for base in map(ast.unparse, node.bases):
            named = f"{base.rpartition('.')[2]}.{method}"
            yield from classes.get(named, ())
            yield from above(named, classes)


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


def test_many_arguments_are_told_one_by_one():
    trees = [ast.parse(path.read_text(encoding="utf-8"), path)
             for path in sorted(PACKAGE.rglob("*.py"))]
    assert not lacking(trees), "these lack a section Parameters"
