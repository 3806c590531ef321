"""Opens a served map in headless Chromium and checks its tiles: check_view.py <browser> <address> <map folder>
[<folder for pictures>].

The map folder holds view_expected.json, written by tests/pipeline/map/view_page.cpp from the GeoTIFFs:
  {"title": text, "cells": [{"column", "row", "go": class, "colour": [r, g, b], "p_go": number}]}: cells of the map that
  lie on one screen, some of which the thinned page does not hold.
"""
import json
import os
import pathlib
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import checks  # noqa: E402
from browser import Browser  # noqa: E402
from checks import check  # noqa: E402

PIXELS_PER_CELL = 5


def wait_for_tiles(browser):
    browser.settle()
    browser.until("[...tiles.values()].every((image) => image.complete)")
    browser.settle()


def zoom_to(browser, cells):
    """The middle of the cells in the middle of the screen, a cell a few pixels wide, nothing showing through."""
    column = sum(c["column"] for c in cells) / len(cells) + 0.5
    row = sum(c["row"] for c in cells) / len(cells) + 0.5
    browser.js(f"view.scale = {PIXELS_PER_CELL} / meta.grid.cell_width_m; view.x = {column} * meta.grid.cell_width_m;"
               f" view.y = {row} * meta.grid.cell_height_m; state.opacity = 1; refresh()")
    wait_for_tiles(browser)


def place_of(browser, cell):
    """Pixel of the canvas at the middle of a cell of the map."""
    return browser.js(f"to_screen(({cell['column']} + 0.5) * meta.grid.cell_width_m,"
                      f" ({cell['row']} + 0.5) * meta.grid.cell_height_m)")


def colour_at(browser, x, y):
    return browser.js(f"[...context.getImageData(Math.round({x} * devicePixelRatio), Math.round({y} * devicePixelRatio),"
                      f" 1, 1).data].slice(0, 3)")


def check_tiles(browser, expected):
    check(browser.js("served") is True, "a thinned page that is served reads tiles")
    check(not [r for r in browser.requests() if "/tile/" in r], "the whole region needs no tile")
    zoom_to(browser, expected["cells"])
    check([r for r in browser.requests() if "/tile/go/0/" in r], "zoomed in, tiles of the map's own cells are asked for")
    held = 0
    for cell in expected["cells"]:
        x, y = place_of(browser, cell)
        check(0 < x < browser.js("canvas.clientWidth") and 0 < y < browser.js("canvas.clientHeight"), f"{cell} is seen")
        got = colour_at(browser, x, y)
        check(max(abs(a - b) for a, b in zip(got, cell["colour"])) <= 2, f"{cell} is drawn as {got}")
        step = browser.js("meta.cells.step")
        held += cell["column"] % step == step // 2 and cell["row"] % step == step // 2
    check(held < len(expected["cells"]) / 2, "most of these cells are not in the page itself")


def check_layers(browser):
    for layer, mode, tile in (("p_go", "uphill", "p_go"), ("class", "worst", "go_worst"), ("p_go", "best", "p_go_best"),
                              ("reason", "uphill", "reason")):
        browser.js(f"state.layer = '{layer}'; state.mode = '{mode}'; refresh()")
        wait_for_tiles(browser)
        check([r for r in browser.requests() if f"/tile/{tile}/0/" in r], f"{layer}, {mode}: tiles of {tile}.tif")
    before = len(browser.requests())
    browser.js("state.layer = 'class'; state.mode = 'set'; state.heading = 45; refresh()")
    wait_for_tiles(browser)
    browser.js("state.mode = 'uphill'; state.go = 0.95; refresh()")
    wait_for_tiles(browser)
    check(len(browser.requests()) == before, "no tile stands for another heading or other thresholds")
    browser.js("state.go = meta.rules.go; refresh()")
    wait_for_tiles(browser)


def check_click(browser, expected):
    cell = next(c for c in expected["cells"] if c["column"] % 2 == 0 and c["p_go"] is not None)
    x, y = place_of(browser, cell)
    box = browser.js("(() => { const b = canvas.getBoundingClientRect(); return [b.x, b.y]; })()")
    browser.click(x + box[0], y + box[1])
    browser.until("document.getElementById('served-cell') !== null")
    text = browser.js("document.getElementById('served-cell').innerText")
    check(f"column {cell['column']}, row {cell['row']}" in text, f"a click reads the very cell: {text!r}")
    check(f"{cell['p_go']:.5g}" in text, f"and its P(go) {cell['p_go']:.5g}: {text!r}")


def check_from_disk(program, folder):
    address = (folder / "index.html").as_uri()
    browser = Browser(program, 1280, 800)
    browser.open(address)
    browser.js("view.scale *= 40; refresh()")
    browser.settle()
    check(browser.requests() == [address], f"from disk the same page asks for nothing: {browser.requests()}")
    browser.close()


def main():
    program, address, folder = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3]).resolve()
    pictures = pathlib.Path(sys.argv[4]) if len(sys.argv) > 4 else None
    expected = json.loads((folder / "view_expected.json").read_text())
    browser = Browser(program, 1280, 800)
    browser.open(address)
    check(browser.js("document.title") == expected["title"], "the page of the map comes")
    if pictures:
        browser.picture(pictures / "served_whole.png")
    check_tiles(browser, expected)
    check_layers(browser)
    check_click(browser, expected)
    if pictures:
        browser.picture(pictures / "served_cell.png")
    check(not browser.complaints(), f"no error: {browser.complaints()[:2]}")
    strangers = [r for r in browser.requests() if not r.startswith(address)]
    check(not strangers, f"nothing comes from elsewhere: {strangers}")
    browser.close()
    check_from_disk(program, folder)
    print(f"{checks.passed} checks passed")


main()
