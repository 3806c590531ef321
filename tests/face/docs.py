#!/usr/bin/env python3
"""The C++ of docs/cpp.md compiles against include/ alone.

    docs.py <compiler> <source tree>
"""
import re
import subprocess
import sys

compiler, root = sys.argv[1:]
with open(f"{root}/docs/cpp.md", encoding="utf-8") as page:
    blocks = re.findall(r"```cpp\n(.*?)```", page.read(), re.S)
if len(blocks) < 3:
    sys.exit("docs/cpp.md: its examples were not found")
heads, bodies = [], []
for block in blocks:
    lines = [line for line in block.splitlines() if not line.startswith("using ")]
    heads += [line for line in lines if line.startswith("#")]
    bodies.append("{\n" + "\n".join(line for line in lines if not line.startswith("#")) + "\n}")
text = "\n".join([*heads, "using namespace gonogo::api;", "void examples() {", *bodies, "}", ""])
sys.exit(subprocess.run([compiler, "-std=c++20", "-fsyntax-only", f"-I{root}/include", "-x", "c++", "-"],
                        input=text, text=True).returncode)
