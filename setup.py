"""Installs the package; the scenes and methods of options/ go with it, as files of
contactsnes/scenes/."""

from setuptools import find_packages, setup

setup(
    packages=[*find_packages(include=["contactsnes*"]), "contactsnes.scenes"],
    package_dir={"contactsnes.scenes": "options"},
    package_data={"contactsnes.scenes": ["*.opts", "*.py", "*.txt"]},
)
