#!/usr/bin/env python3
"""Which source file imports which: circles, layers, lengths and names defined twice.

Run it from the root of the repository; Python 3.9 and its standard library are enough.

    docs/tools/structure.py [--allow FILE]      circles; exit status 1 if one is not listed in FILE
    docs/tools/structure.py --lengths           files above 500 lines; exit status 1 if there is any
    docs/tools/structure.py --lines             source lines of every package, without tests
    docs/tools/structure.py --homonyms          types that several files of one package define
    docs/tools/structure.py --floors [DEPTH]    the layers, folders cut at DEPTH below src
    docs/tools/structure.py --self-test         tries the script on a small tree

How imports are read. Packages are found through their Cargo.toml, files through `mod` declarations from
lib.rs, main.rs and bin/. Every `use`, and every path `a::b` in code, is followed to the file that DEFINES
the name: through re-exports, globs and other packages of the workspace. So

- a mod.rs that re-exports a name is passed through. A re-export by itself is no import, unless the file
  that re-exports also uses the name;
- importing a module is no import of its file; `module::name` is one of the file that defines `name`;
- neither `mod x;` nor a link in a comment is an import;
- a name that a macro makes is taken to be defined in the module that the path names;
- what only a method call reaches is not seen;
- whatever stands under #[cfg(test)], in tests/ or in benches/ is left out.

FILE has one circle a line, its files separated by spaces, and comments after #. A circle passes if all its
files stand on one line.
"""

import argparse
import itertools
import re
import sys
import tempfile
import textwrap
from collections import defaultdict, namedtuple
from pathlib import Path

LIMIT = 500
MANIFESTS = ("Cargo.toml", "synth/Cargo.toml", "synth/*/Cargo.toml", "runtime/Cargo.toml")
TYPES = ("struct", "enum", "union", "trait", "type")

NOT_CODE = re.compile(
    r'//[^\n]*|/\*.*?\*/|\bb?r(?P<hash>#*)".*?"(?P=hash)|"(?:\\.|[^"\\])*"'
    r"|'(?:\\(?:u\{[^}]*\}|x..|.)|[^\\'])'",
    re.S,
)
TEST_ONLY = re.compile(r"#\[cfg\((?:all\()?\s*test\b[^\]]*\]\s*(?:#\[[^\]]*\]\s*)*")
NAME = re.compile(r'^\[package\][^\[]*?^name\s*=\s*"([^"]+)"', re.M)
DEPENDENCY = re.compile(r'^([\w-]+)\s*=\s*\{[^}\n]*path\s*=\s*"([^"]+)"', re.M)
USE = re.compile(r"(?P<public>\bpub(?:\s*\([^)]*\))?\s+)?\buse\s+(?P<tree>[^;]+);")
FILE_MODULE = re.compile(r"(?:\bpub(?:\s*\([^)]*\))?\s+)?\bmod\s+(\w+)\s*;")
INLINE_MODULE = re.compile(r"\bmod\s+(\w+)\s*\{")
DEFINITION = re.compile(
    r"(?<![*<'])\b(struct|enum|union|trait|type|fn|const|static|macro_rules!)\s+(?:mut\s+)?"
    r"(?!(?:fn|unsafe|extern|async)\b)([A-Za-z_]\w*)"
)
PATH = re.compile(r"(?:::\s*)?\b[A-Za-z_]\w*(?:\s*::\s*[A-Za-z_]\w*)+")

# Where a path ends; OUTSIDE stands for any item of another library.
Item = namedtuple("Item", "file name")
OUTSIDE = Item(None, None)


class Module:
    """One module: what it defines, what it imports, and its code without comments, tests and imports."""

    def __init__(self, file, parent=None):
        self.file, self.parent, self.root = file, parent or self, parent.root if parent else self
        self.children, self.kinds, self.imports, self.globs, self.code = {}, {}, [], [], ""


def blank(text, start, end):
    """The text with a part of it blank; offsets and lines stay where they are."""
    return text[:start] + re.sub(r"[^\n]", " ", text[start:end]) + text[end:]


def only_code(text):
    """The text without comments and literals. A literal that is a path stays: serde takes such."""

    def replace(found):
        is_path = re.fullmatch(r'"\w+(?:::\w+)+"', found.group())
        return found.group().replace('"', " ") if is_path else re.sub(r"[^\n]", " ", found.group())

    return NOT_CODE.sub(replace, text)


def test_ranges(code):
    """Where the items under #[cfg(test)] start and end."""
    end = 0
    for found in TEST_ONLY.finditer(code):
        if found.start() >= end:
            depth = 0
            for mark in re.compile(r"[(\[{}\]);]").finditer(code, found.end()):
                depth += (mark.group() in "([{") - (mark.group() in ")]}")
                if depth <= 0 and mark.group() in ";}":
                    break
            end = mark.end()
            yield found.start(), end


def outer_level(code):
    """The code with everything between braces blank."""
    depth, start, out = 0, 0, code
    for mark in re.finditer(r"[{}]", code):
        depth += 1 if mark.group() == "{" else -1
        if depth == 1 and mark.group() == "{":
            start = mark.end()
        elif depth == 0:
            out = blank(out, start, mark.start())
    return out


def use_tree(tree, prefix=()):
    """Every import of a use tree: its path, and the name that it gets here (`*` for a glob)."""
    if "{" in tree:
        head, inner = tree[: tree.index("{")], tree[tree.index("{") + 1 : tree.rindex("}")]
        prefix += tuple(part.strip() for part in head.split("::")[:-1])
        depth, part = 0, ""
        for letter in inner + ",":
            depth += (letter == "{") - (letter == "}")
            part += letter
            if letter == "," and depth == 0:
                yield from use_tree(part[:-1], prefix) if part[:-1].strip() else ()
                part = ""
        return
    tree, _, alias = " ".join(tree.split()).partition(" as ")
    path = prefix + tuple(tree.replace(" ", "").split("::"))
    path = path[:-1] if path[-1] == "self" and len(path) > 1 else path
    yield path, alias or path[-1]


def read_module(module, code, folder):
    """Fills a module from its code; the files of its children stand in `folder`."""
    flat = outer_level(code)
    for found in INLINE_MODULE.finditer(flat):
        end = flat.index("}", found.end())
        module.children[found.group(1)] = Module(module.file, module)
        read_module(module.children[found.group(1)], code[found.end() : end], folder / found.group(1))
        code, flat = blank(code, found.end(), end), blank(flat, found.start(), end + 1)
    for found in FILE_MODULE.finditer(flat):
        name = found.group(1)
        for file in (folder / f"{name}.rs", folder / name / "mod.rs"):
            if file.is_file():
                module.children[name] = read_file(file, folder / name, module)
        code = blank(code, *found.span())
    module.kinds = {name: kind for kind, name in DEFINITION.findall(flat)}
    for found in USE.finditer(code):
        for path, name in use_tree(found.group("tree")):
            if name == "*":
                module.globs.append(path[:-1])
            else:
                module.imports.append((path, name, bool(found.group("public"))))
        code = blank(code, *found.span())
    module.code = code


def read_file(file, folder, parent=None):
    code = only_code(file.read_text(encoding="utf-8"))
    for span in list(test_ranges(code)):
        code = blank(code, *span)
    module = Module(file, parent)
    read_module(module, code, folder)
    return module


class Tree:
    """All packages of the repository, and `imports`: file -> file -> names."""

    def __init__(self, root):
        self.root = Path(root).resolve()
        self.sources, self.libraries, self.modules = [], {}, []
        manifests = (file for pattern in MANIFESTS for file in sorted(self.root.glob(pattern)))
        texts = {file.parent: file.read_text(encoding="utf-8") for file in manifests}
        for folder, text in texts.items():
            source = folder / "src"
            if NAME.search(text) and source.is_dir():
                self.sources.append(source)
                tops = [source / "lib.rs", source / "main.rs", *sorted(source.glob("bin/*.rs"))]
                self.modules += [read_file(file, file.parent) for file in tops if file.is_file()]
        homes = {top.file.parent.parent: top for top in self.modules if top.file.name == "lib.rs"}
        for folder, text in texts.items():
            for name, place in [(name, "") for name in NAME.findall(text)] + DEPENDENCY.findall(text):
                if (folder / place).resolve() in homes:
                    self.libraries[name.replace("-", "_")] = homes[(folder / place).resolve()]
        for module in self.modules:
            self.modules.extend(module.children.values())
        self.files = sorted({module.file for module in self.modules})
        self.imports = defaultdict(lambda: defaultdict(set))
        for module in self.modules:
            for item in self.used(module):
                if isinstance(item, Item) and item.file not in (None, module.file):
                    self.imports[module.file][item.file].add(item.name)

    def name(self, file):
        return file.relative_to(self.root).as_posix()

    def lookup(self, module, name, as_module, seen):
        """What a name means in a module: a module, an item, OUTSIDE, or None where it means nothing."""
        if (module, name, as_module) in seen:
            return None
        seen = seen | {(module, name, as_module)}
        bound = (self.follow(module, path, as_module, seen) for path, to, _ in module.imports if to == name)
        own = [Item(module.file, name)] if name in module.kinds else []
        child = [module.children[name]] if name in module.children else []
        sources = (self.follow(module, path, True, seen) for path in module.globs)
        globs = (self.lookup(at, name, as_module, seen) for at in sources if isinstance(at, Module))
        meanings = itertools.chain(child if as_module else own, bound, own, child, globs)
        return next((found for found in meanings if found is not None), None)

    def follow(self, module, path, as_module=False, seen=frozenset()):
        """Where a path leads from a module. Its end means a module only where `as_module`, or if need be."""
        first, rest = path[0], path[1:]
        if first in ("crate", "self", "super"):
            at = {"crate": module.root, "self": module, "super": module.parent}[first]
        elif first == "":
            at, rest = self.libraries.get(path[1], OUTSIDE), path[2:]
        else:
            at = self.lookup(module, first, as_module or bool(rest), seen) or self.libraries.get(first)
            if at is None:
                return OUTSIDE if rest else None
        for index, part in enumerate(rest, 1):
            if not isinstance(at, Module):
                break
            if part in ("self", "super"):
                at = at if part == "self" else at.parent
            else:
                inner = self.lookup(at, part, as_module or index < len(rest), seen)
                at = Item(at.file, part) if inner is None else inner
        return at

    def used(self, module):
        """Every item that a module imports or names."""
        words = set(re.findall(r"[A-Za-z_]\w*", module.code))
        for path, name, public in module.imports:
            if not public or name in words:
                yield self.follow(module, path)
        for path in module.globs:
            source = self.follow(module, path, True)
            for word in words - set(module.kinds) if isinstance(source, Module) else ():
                yield self.lookup(source, word, False, frozenset())
        for path in set(PATH.findall(module.code)):
            yield self.follow(module, [part.strip() for part in path.split("::")])


def components(nodes, arrows):
    """Strongly connected components, each after all that it reaches."""
    reach = {}
    for node in nodes:
        reach[node], waiting = set(), [node]
        while waiting:
            new = set(arrows.get(waiting.pop(), ())) - reach[node]
            reach[node] |= new
            waiting += new
    parts = {tuple(sorted({node} | {each for each in reach[node] if node in reach[each]})) for node in nodes}
    return sorted(parts, key=lambda part: (len(reach[part[0]].union(part)), part))


def floors(nodes, arrows):
    """The nodes of every floor from the top down, with the number of the floor; 1 is the ground."""
    floor = {}
    for part in components(nodes, arrows):
        below = [floor[target] for node in part for target in arrows.get(node, ()) if target not in part]
        floor.update(dict.fromkeys(part, 1 + max(below, default=0)))
    for level in sorted(set(floor.values()), reverse=True):
        yield level, sorted(node for node in nodes if floor[node] == level)


def print_circles(tree, allow):
    lines = allow.read_text(encoding="utf-8") if allow else ""
    allowed = [set(line.split("#")[0].split()) for line in lines.splitlines()]
    circles = sorted(part for part in components(tree.files, tree.imports) if len(part) > 1)
    new = 0
    for number, part in enumerate(circles, 1):
        passes = any({tree.name(file) for file in part} <= each for each in allowed)
        new += not passes
        print(f"circle {number}: {len(part)} files{', allowed' if passes else ''}")
        print(*(f"  {tree.name(file)}" for file in part), sep="\n")
        for file, target in itertools.permutations(part, 2):
            if target in tree.imports[file]:
                names = ", ".join(sorted(tree.imports[file][target]))
                print(f"    {tree.name(file)} -> {tree.name(target)}: {names}")
    print(f"{len(circles)} circles in {len(tree.files)} files, {new} of them not allowed")
    return new > 0


def print_lengths(tree):
    lengths = {file: file.read_text(encoding="utf-8").count("\n") for file in tree.files}
    above = [file for file in sorted(lengths, key=lengths.get, reverse=True) if lengths[file] > LIMIT]
    print(*(f"{lengths[file]:5} {tree.name(file)}\n" for file in above), sep="", end="")
    print(f"{len(above)} of {len(lengths)} files are above {LIMIT} lines")
    return len(above) > 0


def source_lines(file):
    text = file.read_text(encoding="utf-8")
    return text.count("\n") - sum(text.count("\n", *span) + 1 for span in test_ranges(only_code(text)))


def print_lines(tree):
    for source in tree.sources:
        lines = sum(source_lines(file) for file in tree.files if source in file.parents)
        print(f"{lines:6} {tree.name(source)}")
    print(f"{sum(map(source_lines, tree.files)):6} in all")


def print_homonyms(tree):
    for source in tree.sources:
        places = defaultdict(set)
        for module in (module for module in tree.modules if source in module.file.parents):
            for name in (name for name, kind in module.kinds.items() if kind in TYPES):
                places[name].add(f"{tree.name(module.file)} ({module.kinds[name]})")
        for name, files in sorted(places.items()):
            if len(files) > 1:
                print(f"{tree.name(source)}: {name}: {', '.join(sorted(files))}")


def print_floors(tree, depth):
    def folder(file):
        own = file.with_suffix("") if file.with_suffix("").is_dir() else file.parent
        parts = tree.name(own).split("/")
        return "/".join(parts[: parts.index("src") + 1 + depth])

    files, uses = defaultdict(list), defaultdict(set)
    for file in tree.files:
        files[folder(file)].append(file)
        uses[folder(file)] |= {folder(target) for target in tree.imports[file]} - {folder(file)}
    circle = {each: part for part in components(files, uses) for each in part}
    print("Folders: each stands above all that it uses; those joined by <-> use each other in a circle.")
    for level, at in floors(files, uses):
        for name in at:
            lines = sum(map(source_lines, files[name]))
            print(f"\n{level:3} ┌─ {name}  ({len(files[name])} files, {lines} lines)")
            arrows = [("<->~" if each in circle[name] else "->~") + each for each in sorted(uses[name])]
            for row in textwrap.wrap("  ".join(arrows), 100, break_on_hyphens=False):
                print("    │    " + row.replace("~", " "))
    print("\nFiles: each stands above all that it imports; the files of a circle stand on one floor.\n")
    tied = {each for file in tree.files if tree.imports[file] for each in (file, *tree.imports[file])}
    for level, at in floors(tied, tree.imports):
        rows = itertools.groupby(sorted(at, key=lambda file: (file.parent, file)), lambda file: file.parent)
        for index, (parent, row) in enumerate(rows):
            print(f"{'' if index else level:3} │ {tree.name(parent)}/ {' '.join(file.name for file in row)}")


SAMPLE = {
    "Cargo.toml": '[package]\nname = "top"\n[dependencies]\nlow = { package = "low-er", path = "synth" }\n',
    "synth/Cargo.toml": '[package]\nname = "low-er"\n',
    "synth/src/lib.rs": "pub mod deep;\n",
    "synth/src/deep/mod.rs": "mod inner;\npub(crate) use inner::Form;\npub struct Own;\n",
    "synth/src/deep/inner.rs": "pub enum Form { A }\nimpl Form { pub fn new(_: super::Own) {} }\n",
    "src/lib.rs": "mod a;\nmod b;\nmod page;\npub mod c;\nuse a::A;\nmod inline { use super::b::B; }\n",
    "src/a.rs": "use crate::{b::{self, B}, c as see};\npub struct A;\nfn f() { see::run(b::g()) } // low::a\n",
    "src/b.rs": "pub use crate::a::A as Z;\nstruct B;\nfn g() {}\n#[cfg(test)]\nmod t {\nuse super::Z;\n}\n",
    "src/c.rs": "use low::deep::Form;\nstruct B;\npub const fn run(_: u8) { '}'; crate::b::Z; Form::A; }\n",
    "src/page/mod.rs": "mod page;\npub use page::*;\npub struct Hidden;\n",
    "src/page/page.rs": "pub fn page() { low_er::deep::Own; super::Hidden; super::super::a::A }\n",
}
SAMPLE_IMPORTS = """src/a.rs src/b.rs B g; src/a.rs src/c.rs run; src/c.rs src/a.rs A; src/lib.rs src/a.rs A;
src/lib.rs src/b.rs B; src/c.rs synth/src/deep/inner.rs Form; src/page/page.rs src/a.rs A;
src/page/page.rs src/page/mod.rs Hidden; src/page/page.rs synth/src/deep/mod.rs Own;
synth/src/deep/inner.rs synth/src/deep/mod.rs Own"""


def self_test():
    with tempfile.TemporaryDirectory() as folder:
        for name, text in SAMPLE.items():
            Path(folder, name).parent.mkdir(parents=True, exist_ok=True)
            Path(folder, name).write_text(text)
        tree, allow = Tree(folder), Path(folder, "allow")
        pairs = [(file, target) for file in tree.files for target in tree.imports[file]]
        found = {" ".join([tree.name(a), tree.name(b), *sorted(tree.imports[a][b])]) for a, b in pairs}
        assert found == {each.strip() for each in SAMPLE_IMPORTS.split(";")}, found
        for text, status in (("# known\nsrc/c.rs src/a.rs\n", False), ("src/a.rs src/b.rs\n", True)):
            allow.write_text(text)
            assert print_circles(tree, allow) == status
        assert source_lines(tree.root / "src/b.rs") == 3
        assert [print_homonyms(tree), print_floors(tree, 99), print_lines(tree)] == [None] * 3
    print("the small tree was read as it should be")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--allow", type=Path, metavar="FILE")
    parser.add_argument("--floors", type=int, nargs="?", const=99, metavar="DEPTH")
    for flag in ("--lengths", "--lines", "--homonyms", "--self-test"):
        parser.add_argument(flag, action="store_true")
    options = parser.parse_args()
    if options.self_test:
        return self_test()
    tree = Tree(".")
    if options.floors is not None:
        return print_floors(tree, options.floors)
    for name, run in (("lengths", print_lengths), ("lines", print_lines), ("homonyms", print_homonyms)):
        if getattr(options, name):
            return run(tree)
    return print_circles(tree, options.allow)


if __name__ == "__main__":
    sys.exit(main())
