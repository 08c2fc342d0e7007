#!/usr/bin/env python3
"""Checks the dependencies of the workspace against deny.toml: licences, duplicate versions and sources.

  tools/dependencies.py

Reads `cargo metadata`, so it needs nothing but Cargo and Python 3.11. `cargo deny check licenses bans sources` reads the same
file and finds the same faults. Exits with 1 if it finds one.
"""
import collections
import json
import pathlib
import re
import subprocess
import sys
import tomllib

CRATES_IO = "registry+https://github.com/rust-lang/crates.io-index"
TOKEN = re.compile(r"\(|\)|\bAND\b|\bOR\b|/|[\w.+-]+(?: WITH [\w.+-]+)?")


def is_allowed(expression, allowed):
    """Evaluates an SPDX expression. The old form `MIT/Apache-2.0` means OR. AND binds tighter than OR."""
    tokens = TOKEN.findall(expression)

    def alternatives():
        result = conjunction()
        while tokens and tokens[0] in ("OR", "/"):
            tokens.pop(0)
            result = conjunction() or result
        return result

    def conjunction():
        result = term()
        while tokens and tokens[0] == "AND":
            tokens.pop(0)
            result = term() and result
        return result

    def term():
        token = tokens.pop(0)
        if token != "(":
            return token in allowed
        result = alternatives()
        tokens.pop(0)
        return result

    return alternatives()


def faults(packages, rules):
    allowed = set(rules["licenses"]["allow"])
    accepted_duplicates = {entry["crate"] for entry in rules["bans"]["skip"]}
    versions = collections.defaultdict(set)
    for package in packages:
        name = f"{package['name']} {package['version']}"
        versions[package["name"]].add(package["version"])
        if not package["license"] or not is_allowed(package["license"], allowed):
            yield f"{name}: licence {package['license']} is not in the list `allow`"
        if package["source"] not in (None, CRATES_IO):
            yield f"{name}: comes from {package['source']}, expected crates.io"
    duplicates = {name for name, found in versions.items() if len(found) > 1}
    for name in sorted(duplicates - accepted_duplicates):
        yield f"{name}: {len(versions[name])} versions ({', '.join(sorted(versions[name]))}); merge them, or add a `skip` with the reason"
    for name in sorted(accepted_duplicates - duplicates):
        yield f"{name}: has one version now; remove its `skip`"


def main():
    root = pathlib.Path(__file__).parent.parent
    rules = tomllib.loads((root / "deny.toml").read_text())
    command = ["cargo", "metadata", "--locked", "--format-version", "1"]
    packages = json.loads(subprocess.check_output(command, cwd=root))["packages"]
    found = list(faults(packages, rules))
    print("\n".join(found) if found else f"{len(packages)} packages: licences, versions and sources are in order")
    sys.exit(bool(found))


main()
