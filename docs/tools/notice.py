#!/usr/bin/env python3
"""Writes NOTICE: the licences of the third-party crates that are linked into the program.

    python3 docs/tools/notice.py > NOTICE     writes it
    python3 docs/tools/notice.py --check      exit status 1 when NOTICE is out of date

The crates are those that Cargo.lock and the manifests give for the platforms below. Names and licences
are printed without versions, so that an update which changes neither leaves the file as it is. Needs
cargo; sources that are not on this machine yet are downloaded, because the licence is in each crate's
own manifest.
"""

import difflib
import json
import pathlib
import subprocess
import sys

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
NOTICE = REPOSITORY / "NOTICE"
PACKAGE = "steadfast"
PLATFORMS = [
    "aarch64-apple-darwin",
    "aarch64-unknown-linux-gnu",
    "x86_64-pc-windows-msvc",
    "x86_64-unknown-linux-gnu",
]
NOT_STATED = "not stated in the manifest: see the crate's source"

HEAD = """\
Steadfast
Copyright (c) 2026 The Steadfast developers

Steadfast is licensed under the MIT licence (LICENSE-MIT) or the Apache License, Version 2.0
(LICENSE-APACHE), at your choice.

The program contains code of the Rust crates below, on Linux, macOS or Windows; not each of them on
every platform. Where a crate offers several licences, any one of them may be chosen. The copyright
notices and the texts of the licences are in the source of each crate, https://crates.io/crates/NAME.
Whoever passes the program on in binary form must pass them on as well, as most of these licences ask.

Written by docs/tools/notice.py from Cargo.lock; do not edit by hand.
"""

BUILD_HEAD = """\
Used while the program is compiled, and not part of it: procedural macros and what they use.
"""


def cargo(*arguments):
    """The standard output of a cargo command."""
    command = ["cargo", *arguments]
    run = subprocess.run(command, cwd=REPOSITORY, stdout=subprocess.PIPE, text=True)
    if run.returncode != 0:
        sys.exit(f"error: `{' '.join(command)}` failed")
    return run.stdout


def own_crates():
    """Names of the workspace's own crates."""
    metadata = cargo("metadata", "--locked", "--no-deps", "--format-version", "1")
    return {package["name"] for package in json.loads(metadata)["packages"]}


def normalised(licence):
    """A licence expression with its alternatives in one notation and in order."""
    if not licence:
        return NOT_STATED
    if "(" in licence or " AND " in licence:
        return licence
    alternatives = licence.replace("/", " OR ").split(" OR ")
    return " OR ".join(sorted(alternative.strip() for alternative in alternatives))


def third_party(edges, own):
    """Pairs of name and licence of the crates that the program depends on by these edges."""
    arguments = ["tree", "--locked", "--package", PACKAGE, "--edges", edges]
    arguments += ["--prefix", "none", "--no-dedupe", "--format", "{p}\t{l}"]
    for platform in PLATFORMS:
        arguments += ["--target", platform]
    found = set()
    for line in cargo(*arguments).splitlines():
        if not line:
            continue
        package, licence = line.split("\t")
        name = package.split(" ")[0]
        if name not in own:
            found.add((name, normalised(licence)))
    return found


def grouped(crates):
    """The crates, one line each under their licence."""
    lines = []
    for licence in sorted({licence for _, licence in crates}):
        names = sorted(name for name, theirs in crates if theirs == licence)
        lines += ["", licence, *(f"    {name}" for name in names)]
    return "\n".join(lines).lstrip("\n") + "\n"


def notice():
    """The text of NOTICE."""
    own = own_crates()
    linked = third_party("normal,no-proc-macro", own)
    compiling = third_party("normal", own) - linked
    return "\n".join([HEAD, grouped(linked), BUILD_HEAD, grouped(compiling)])


def main():
    arguments = sys.argv[1:]
    if not arguments:
        sys.stdout.write(notice())
    elif arguments == ["--check"]:
        check()
    else:
        print(__doc__, file=sys.stderr)
        sys.exit(2)


def check():
    """Ends with status 1 when NOTICE is not what it should be."""
    written = NOTICE.read_text(encoding="utf-8") if NOTICE.exists() else ""
    text = notice()
    if written != text:
        before, after = written.splitlines(), text.splitlines()
        print("\n".join(difflib.unified_diff(before, after, "NOTICE", "now", lineterm="")))
        sys.exit("error: NOTICE is out of date: run `python3 docs/tools/notice.py > NOTICE`")


main()
