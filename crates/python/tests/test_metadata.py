"""Checks the description of the package that a package index shows."""

from __future__ import annotations

import re
from importlib.metadata import metadata, version

import basrelief
from conftest import ROOT


def test_description_has_readme_keywords_and_classifiers() -> None:
    about = metadata("basrelief")
    readme = (ROOT / "crates/python/README.md").read_text()
    assert about["Description"].strip() == readme.strip()
    assert about["Description-Content-Type"].startswith("text/markdown")
    assert about["Summary"] and about["Author"] and about["Keywords"]
    assert about["License-Expression"] == "MIT OR Apache-2.0"
    assert about.get_all("License-File") == ["LICENSE-APACHE", "LICENSE-MIT"]
    assert about["Requires-Python"] == ">=3.10"
    assert not [need for need in about.get_all("Requires-Dist") or [] if "extra ==" not in need]
    assert version("basrelief") == basrelief.__version__


def test_examples_of_the_readme_run() -> None:
    (example,) = re.findall(r"^```python\n(.*?)^```$", (ROOT / "crates/python/README.md").read_text(), re.MULTILINE | re.DOTALL)
    exec(compile(example.replace('result.image.save("golf-ball.png")', "result.image.png()"), "README.md", "exec"), {})
