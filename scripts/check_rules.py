#!/usr/bin/env python3
"""Checks the rules of CONTRIBUTING.md that a program can check. Prints one line for every violation.

    scripts/check_rules.py                  the tree this script lies in
    scripts/check_rules.py --root FOLDER    another tree
    scripts/check_rules.py --only NAME ...  these rules alone

Each rule is a function named after it. tests/rules/planted.py plants a violation of every rule. Who may include whom is checked by
cmake/check_arrows.cmake, prose by scripts/check_prose.py, format by scripts/format.sh.
"""
import argparse
import re
import subprocess
import sys
from pathlib import Path

SOURCES = (".h", ".cpp", ".cu", ".cuh")
MOST_LINES = 700           # of a file
MOST_FILES = 12            # sources in a folder
MOST_FUNCTION_LINES = 60   # signature to closing brace
MOST_PICTURE_BYTES = 250_000
LONGEST_SUBJECT = 72       # characters of a commit's subject
FIRST_SUBJECT = "2026-11-27T10:00:00+00:00"  # the rule holds for commits written from then on; hashes change when history is rewritten

RULES = {}


def rule(check):
    RULES[check.__name__] = check
    return check


class Tree:
    """The files that git tracks or would track below a folder."""

    def __init__(self, root):
        self.root = Path(root)
        listed = self.git("ls-files", "--cached", "--others", "--exclude-standard")
        self.files = sorted(name for name in set(listed.splitlines()) if (self.root / name).is_file())

    def git(self, *arguments):
        return subprocess.run(["git", "-C", str(self.root), *arguments], capture_output=True, text=True, check=True).stdout

    def text(self, name):
        return (self.root / name).read_text(encoding="utf-8")

    def sources(self, tests=True):
        return [name for name in self.files if name.endswith(SOURCES) and (tests or not name.startswith("tests/"))]

    def find(self, names, pattern):
        """"name:line" of every line that matches; whole-line comments do not count."""
        searched = re.compile(pattern)
        for name in names:
            for number, line in enumerate(self.text(name).split("\n"), 1):
                if not line.lstrip().startswith("//") and searched.search(line):
                    yield f"{name}:{number}"


@rule
def file_length(tree):
    for name in tree.sources():
        lines = tree.text(name).count("\n")
        if lines > MOST_LINES:
            yield f"{name}: {lines} lines; at most {MOST_LINES} are allowed"


@rule
def files_in_a_folder(tree):
    counts = {}
    for name in tree.sources(tests=False):
        counts[str(Path(name).parent)] = counts.get(str(Path(name).parent), 0) + 1
    for folder, count in sorted(counts.items()):
        if count > MOST_FILES:
            yield f"{folder}: {count} source files; at most {MOST_FILES} are allowed"


def functions(text):
    """(line, count of lines) of functions at namespace or class scope, by the indentation that clang-format gives them."""
    first = re.compile(r"^( {0,2})(?=[A-Za-z~])(?!(template|namespace|extern|struct|class|enum|union|using|return|public|private|case|if|for|while)\b)")
    signature, start, indent = None, None, ""
    for number, line in enumerate(text.split("\n"), 1):
        if start is not None:
            if line in (indent + "}", indent + "};", indent + "});"):
                yield start, number - start + 1
                start = None
            continue
        found = first.match(line)
        if signature is None and found:
            signature, indent = number, found.group(1)
        if signature is not None and line.endswith("{"):
            start, signature = signature, None
        elif not line.strip() or line.endswith((";", "}", ":")) or line.lstrip().startswith("//"):
            signature = None


@rule
def function_length(tree):
    names = [name for name in tree.sources(tests=False) if not name.startswith("python/src/")]  # bindings are lists of names
    for name in names:
        for line, count in functions(tree.text(name)):
            if count > MOST_FUNCTION_LINES:
                yield f"{name}:{line}: a function of {count} lines; at most {MOST_FUNCTION_LINES} are allowed"


@rule
def own_header_first(tree):
    for name in tree.sources():
        header = str(Path(name).with_suffix(".h"))
        if not name.endswith(".cpp") or header not in tree.files:
            continue
        included = re.findall(r'^#include ["<]([^">]+)[">]', tree.text(name), re.MULTILINE)
        if not included or included[0] != header:
            yield f"{name}: includes {included[0] if included else 'nothing'} first; its own header {header} comes first"


@rule
def compiler_switch(tree):
    names = [name for name in tree.sources() if not name.startswith("base/")]
    for place in tree.find(names, r"__CUDACC__"):
        yield f"{place}: __CUDACC__ is tested only in base/"


@rule
def one_index(tree):
    """A name that hides one of ours changes the layout of structs in the sources that are compiled with it."""
    for place in tree.find(tree.sources(tests=False), r"^using (\w+::)+(Index|Real|Vec3d?|Mat3|Quat|View)\b"):
        yield f"{place}: write the name with its namespace; it hides ours in sources that are compiled together"


@rule
def public_headers(tree):
    """What is installed stands on itself, and nothing inside stands on it."""
    for name in tree.sources():
        for number, line in enumerate(tree.text(name).split("\n"), 1):
            included = re.match(r'\s*#\s*include\s*([<"])([^>"]*)', line)
            if not included:
                continue
            bracket, header = included.groups()
            ours = bracket == "<" and header.startswith("gonogo/")
            standard = bracket == "<" and re.fullmatch(r"[a-z_]+", header)
            if name.startswith("include/") and not standard and not (ours and f"include/{header}" in tree.files):
                yield f"{name}:{number}: includes {header}; a public header includes the standard library and <gonogo/...> only"
            if ours and not name.startswith(("include/", "pipeline/face/", "tests/face/", "examples/")):
                yield f"{name}:{number}: includes {header}, which is for users; include the header inside"


@rule
def strict_arithmetic(tree):
    names = [name for name in tree.files if name.endswith(("CMakeLists.txt", ".cmake", "CMakePresets.json"))]
    for place in tree.find(names, r"fast-math|use_fast_math|Ofast|fmad=true|ffp-contract=(on|fast)"):
        yield f"{place}: no option may reorder or fuse floating-point operations"


@rule
def exceptions(tree):
    names = [name for name in tree.sources() if not name.startswith(("tests/", "python/"))]
    for place in tree.find(names, r"throw std::(?!bad_alloc)"):
        yield f"{place}: throw InputError, DeviceError or Cancelled (base/error.h)"


@rule
def one_parallel_loop(tree):
    """An exception that leaves a thread of OpenMP ends the process. Kernels of base/parallel are compiled for GPUs and cannot throw."""
    names = [name for name in tree.sources(tests=False) if not name.startswith("base/parallel/")]
    for place in tree.find(names, r"#\s*pragma omp (parallel|for|critical|task|sections)"):
        yield f"{place}: loop by base/parallel/host_loop.h, which carries out what a thread throws"


@rule
def whole_files(tree):
    names = [name for name in tree.sources() if not name.startswith(("base/", "tests/", "examples/"))]
    for place in tree.find(names, r"std::ofstream(?!.*(std::ios::app|may be lost))|std::fopen\([^)]*\"w"):
        yield f"{place}: write files with base/files/file.h, so that they are whole or absent"


@rule
def tests_never_skip(tree):
    names = [name for name in tree.files if name.startswith(("tests/", "python/tests/")) and name.endswith((".cpp", ".py"))]
    names = [name for name in names if name != "tests/rules/planted.py"]
    for place in tree.find(names, r"\bSKIP\(|TEST_CASE.*\[\.(?!speed|table)|\[!mayfail\]|\[!shouldfail\]|pytest\.(mark\.)?(skip|xfail)|importorskip"):
        yield f"{place}: tests never skip and never may fail"


@rule
def picture_size(tree):
    for name in tree.files:
        size = (tree.root / name).stat().st_size
        if name.endswith((".png", ".jpg", ".gif")) and size > MOST_PICTURE_BYTES:
            yield f"{name}: {size} bytes; at most {MOST_PICTURE_BYTES} are allowed (scripts/shrink_pictures.sh)"


@rule
def named_paths(tree):
    """Paths of code in backquotes or links of pages; "*", "<name>" and capitals stand for any name."""
    rooms = "base|sim|vehicle|terrain|learning|pipeline|python|tests|scripts|cmake|include|examples"
    named = re.compile(rf"[`(]((?:\.\./)*(?:{rooms})/[\w./-]*\w)(?=[`)#:])")
    folders = {str(parent) for name in tree.files for parent in Path(name).parents}
    for name in tree.files:
        if not name.endswith(".md") or name.startswith(("docs/log/", "CHANGELOG")):
            continue
        for number, line in enumerate(tree.text(name).split("\n"), 1):
            for path in named.findall(line):
                path = path.lstrip("./")
                if path not in folders and path not in tree.files:
                    yield f"{name}:{number}: there is no {path}"


@rule
def subjects(tree):
    if not (tree.root / ".git").exists():
        return  # a release archive has no history
    for line in tree.git("log", "--no-merges", "--format=%aI%x09%h%x09%s").splitlines():
        date, commit, subject = line.split("\t", 2)
        if date < FIRST_SUBJECT:
            continue
        if len(subject) > LONGEST_SUBJECT:
            yield f"commit {commit}: a subject of {len(subject)} characters; at most {LONGEST_SUBJECT} are allowed"
        first = subject.split()[0] if subject.split() else ""
        if not re.fullmatch(r"[A-Z][a-z-]+", first) or re.search(r"(ed|ing)$", first) and first not in ("Embed", "Feed", "Need", "Speed", "Bring"):
            yield f"commit {commit}: '{subject}': begin with a verb in the imperative (Add, Fix, Refuse ...)"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--root", default=Path(__file__).resolve().parent.parent)
    parser.add_argument("--only", nargs="+", choices=sorted(RULES), default=sorted(RULES))
    arguments = parser.parse_args()
    tree = Tree(arguments.root)
    if not tree.files:
        sys.exit(f"{arguments.root}: git tracks no files here")
    violations = [f"[{name}] {violation}" for name in arguments.only for violation in RULES[name](tree)]
    print("\n".join(violations + [f"{len(violations)} violations of {len(arguments.only)} rules in {len(tree.files)} files"]))
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
