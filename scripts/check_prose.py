#!/usr/bin/env python3
"""Checks the prose of the Markdown files: no sentence over 40 words, and 90 % of all sentences under 25.

    scripts/check_prose.py                  all .md files that git tracks
    scripts/check_prose.py docs/map.md ...  only these files; lists every sentence over 24 words

Code blocks do not count. Inline code and a number with its unit count as one word. Each table cell, list item and
heading holds sentences of its own.
"""
import re
import subprocess
import sys
from pathlib import Path

LONGEST = 40        # words in any sentence
USUAL = 25          # 90 % of all sentences have fewer
USUAL_SHARE = 0.9
NOT_OURS = ("LICENSE",)


def blocks(text):
    """Yields (line number, text) of every paragraph, list item, heading and table cell."""
    paragraph, start, fenced = [], 0, False
    for number, line in enumerate(text.split("\n") + [""], 1):
        stripped = line.strip()
        if stripped.startswith(("```", "~~~")):
            fenced = not fenced
            stripped = ""
        is_code = fenced or (line.startswith("    ") and not paragraph)
        is_row = stripped.startswith("|")
        begins_block = re.match(r"([-*+]|\d+\.|#+|>)\s", stripped) is not None
        if (not stripped or is_code or is_row or begins_block) and paragraph:
            yield start, " ".join(paragraph)
            paragraph = []
        if is_code or not stripped:
            continue
        if is_row:
            if not re.fullmatch(r"[|:\-\s]+", stripped):
                for cell in re.split(r"(?<!\\)\|", stripped.strip("|")):
                    yield number, cell
            continue
        if not paragraph:
            start = number
        paragraph.append(re.sub(r"^([-*+]|\d+\.|#+|>)\s+", "", stripped))


def sentences(block):
    block = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", block)   # a link counts as its text
    block = re.sub(r"`[^`]*`", "code", block)
    block = re.sub(r"<[^>]+>|[*_]{1,3}", " ", block)
    block = re.sub(r"\b(e\.g|i\.e|cf|vs|Fig|Eq|Sec|et al|approx|No)\.", r"\1", block)
    return [part for part in re.split(r"(?<=[.!?])[\"')]*\s+", block) if part.strip()]


def word_count(sentence):
    sentence = re.sub(r"(\d)\s+(m/s|mm|cm|km/h|km|ms|ns|kPa|MPa|kN|Hz|GiB|MiB|kB|%|s|m|N|kg|deg)\b", r"\1\2", sentence)
    return sum(1 for word in sentence.split() if re.search(r"\w", word))


def tracked_files():
    listed = subprocess.run(["git", "ls-files", "*.md"], capture_output=True, text=True, check=True).stdout.split()
    return [name for name in listed if not name.endswith(NOT_OURS)]


def main():
    named = sys.argv[1:]
    lengths, faults = [], []
    for name in named or tracked_files():
        for line, block in blocks(Path(name).read_text(encoding="utf-8")):
            for sentence in sentences(block):
                words = word_count(sentence)
                if words == 0:
                    continue
                lengths.append(words)
                shown = f"{name}:{line}: {words} words: {sentence.strip()[:110]}"
                if words > LONGEST:
                    faults.append(shown)
                elif named and words >= USUAL:
                    print(shown)
    share = sum(length < USUAL for length in lengths) / max(len(lengths), 1)
    print(f"{len(lengths)} sentences, {100 * share:.1f} % under {USUAL} words, longest {max(lengths, default=0)}")
    if share < USUAL_SHARE:
        faults.append(f"{100 * share:.1f} % of the sentences have under {USUAL} words; {100 * USUAL_SHARE:.0f} % should")
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
