"""Counts what a page's test has checked; the first check that fails ends it."""

passed = 0


def check(truth, what):
    global passed
    if not truth:
        raise SystemExit("FAILED: " + what)
    passed += 1
