#!/usr/bin/env python3
"""Checks that every locked dependency builds with the minimum Rust version that Cargo.toml states.

    python3 docs/tools/minimum_rust.py

Reads `cargo metadata --locked`. Exit status 1, with a list, where a dependency declares a newer version. A dependency
that declares none is taken to have none; the workflow in .github builds with the stated version itself.
"""

import json
import subprocess
import sys


def version(text):
    parts = (text.split("-")[0].split(".") + ["0", "0"])[:3]
    return tuple(int(part) for part in parts)


def main():
    command = ["cargo", "metadata", "--locked", "--format-version", "1"]
    packages = json.loads(subprocess.check_output(command))["packages"]
    stated = next(package["rust_version"] for package in packages if package["name"] == "steadfast")
    newer = [
        f"{package['name']} {package['version']} needs Rust {package['rust_version']}"
        for package in packages
        if package["rust_version"] and version(package["rust_version"]) > version(stated)
    ]
    for line in sorted(newer):
        print(line)
    print(f"{len(packages)} packages, stated minimum {stated}, {len(newer)} need more")
    return 1 if newer else 0


if __name__ == "__main__":
    sys.exit(main())
