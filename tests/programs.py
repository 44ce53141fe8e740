"""Programs without a package, of scripts/ and examples/, as modules for tests of any room."""

import importlib.machinery
import importlib.util
import sys
from pathlib import Path


def load(path):
    """A program as a module, known by its name and the suffix ``_program`` (classes of data ask for
    that), without bytecode beside it."""
    path = Path(path)
    name = f"{path.stem.replace('-', '_')}_program"
    loader = importlib.machinery.SourceFileLoader(name, str(path))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    sys.modules[name] = module
    before, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    try:
        loader.exec_module(module)
    finally:
        sys.dont_write_bytecode = before
    return module
