#!/usr/bin/env python3
"""Every rule of scripts/check_rules.py and scripts/check_prose.py catches a planted violation, and lets a clean tree pass.

    planted.py <source tree>
"""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

SOURCE = Path(sys.argv[1])
RULES = SOURCE / "scripts/check_rules.py"
PROSE = SOURCE / "scripts/check_prose.py"
LATER = "2030-01-01T00:00:00+00:00"

LONG_FUNCTION = "void f() {\n" + "  g();\n" * 60 + "}\n"
LONG_SENTENCE = "word " * 41 + "end.\n"

# rule: files that break it
PLANTED = {
    "file_length": {"sim/a.h": "// one line\n" * 701},
    "files_in_a_folder": {f"sim/part_{k}.h": "// part\n" for k in range(13)},
    "function_length": {"sim/a.cpp": LONG_FUNCTION},
    "own_header_first": {"sim/a.h": "void f();\n", "sim/a.cpp": '#include <vector>\n#include "sim/a.h"\n'},
    "compiler_switch": {"sim/a.h": "#ifdef __CUDACC__\n#endif\n"},
    "one_index": {"sim/a.cpp": "using Eigen::Index;\n"},
    "public_headers": {"include/gonogo/a.h": '#include "sim/a.h"\n', "base/a.cpp": "#include <gonogo/a.h>\n"},
    "strict_arithmetic": {"sim/CMakeLists.txt": "target_compile_options(sim PRIVATE -ffast-math)\n"},
    "exceptions": {"sim/a.cpp": 'void f() { throw std::runtime_error("no"); }\n'},
    "one_parallel_loop": {"sim/a.cpp": "#pragma omp parallel for\n"},
    "whole_files": {"sim/a.cpp": 'std::ofstream file("x");\n'},
    "tests_never_skip": {"tests/sim/a.cpp": 'TEST_CASE("later", "[.slow]") {}\n'},
    "picture_size": {"docs/a.png": "x" * 250_001},
    "named_paths": {"docs/a.md": "The cone is in `sim/cone.h`.\n"},
}
CLEAN = {
    "README.md": "It maps.\n",
    "sim/a.h": "void f();\n",
    "sim/a.cpp": '#include "sim/a.h"\n\nvoid f() {\n  g();\n}\n',
    "tests/sim/a.cpp": 'TEST_CASE("a sphere falls") {}\n',
}
BAD_SUBJECTS = ["Added a solver", "Solver: faster", "x" * 73, "Add " + "y" * 70]


def tree_with(folder, files, subject="Add files"):
    for name, text in {**CLEAN, **files}.items():
        path = Path(folder) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    git = ["git", "-C", folder, "-c", "user.name=test", "-c", "user.email=test@example.org", "-c", "commit.gpgsign=false"]
    subprocess.run([*git, "init", "-q"], check=True)
    subprocess.run([*git, "add", "-A"], check=True)
    subprocess.run([*git, "commit", "-q", "-m", subject, "--date", LATER], check=True)


def check(script, *arguments, cwd=None):
    run = subprocess.run([sys.executable, str(script), *arguments], capture_output=True, text=True, cwd=cwd)
    return run.returncode, run.stdout + run.stderr


def expect(condition, message):
    if not condition:
        sys.exit(message)


def main():
    with tempfile.TemporaryDirectory() as folder:
        tree_with(folder, {})
        status, output = check(RULES, "--root", folder)
        expect(status == 0, f"a clean tree was refused:\n{output}")
    for rule, files in PLANTED.items():
        with tempfile.TemporaryDirectory() as folder:
            tree_with(folder, files)
            status, output = check(RULES, "--root", folder)
            expect(status == 1 and f"[{rule}]" in output, f"{rule}: the planted violation was let through:\n{output}")
    for subject in BAD_SUBJECTS:
        with tempfile.TemporaryDirectory() as folder:
            tree_with(folder, {}, subject)
            status, output = check(RULES, "--root", folder, "--only", "subjects")
            expect(status == 1 and "[subjects]" in output, f"the subject '{subject}' was let through")
    with tempfile.TemporaryDirectory() as folder:
        tree_with(folder, {"docs/a.md": LONG_SENTENCE})
        status, output = check(PROSE, cwd=folder)
        expect(status == 1 and "docs/a.md" in output, f"a sentence of 42 words was let through:\n{output}")

    # The page for contributors names every rule, and only rules that exist.
    sys.path.insert(0, str(RULES.parent))
    import check_rules

    rules = set(check_rules.RULES)
    expect(rules == {*PLANTED, "subjects"}, f"rules without a planted violation: {rules ^ {*PLANTED, 'subjects'}}")
    page = set(re.findall(r"^\| `(\w+)` \|", (SOURCE / "CONTRIBUTING.md").read_text(encoding="utf-8"), re.MULTILINE))
    expect(page == rules, f"CONTRIBUTING.md and scripts/check_rules.py name different rules: {page ^ rules}")
    print(f"{len(rules)} rules catch what was planted")


if __name__ == "__main__":
    main()
