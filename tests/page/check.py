"""Opens a map's page in headless Chromium and checks it: check.py <browser> <map folder> [<folder for pictures>].

The map folder holds index.html and expected.json, written by tests/pipeline/map/page.cpp from the GeoTIFFs:
  {"title": text, "cells": [{"column", "row", "verdict", "reason", "p_go": number or null, "p_worst", "p_best"}],
   "route": {"start": cell, "end": cell, "fastest": cost, "safest": cost, "shortest": cost}}
"""
import json
import os
import pathlib
import sys
from xml.etree import ElementTree

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import checks  # noqa: E402
from browser import Browser  # noqa: E402
from checks import check  # noqa: E402


def screen_position(browser, cell):
    return browser.js(f"(() => {{ const [x, y] = to_screen(...centre_of({cell})), b = canvas.getBoundingClientRect();"
                      f" return [x + b.x, y + b.y]; }})()")


def check_cells(browser, expected, columns):
    for cell in expected["cells"]:
        number = cell["row"] * columns + cell["column"]
        got = browser.js(f"(() => {{ const a = answer_of({number}, 'uphill'); return a && {{v: a.verdict, r: a.reason,"
                         f" p: Number.isNaN(a.p) ? null : a.p, w: answer_of({number}, 'worst').p,"
                         f" b: answer_of({number}, 'best').p}}; }})()")
        where = f"cell {cell} shows {got}"
        if cell["verdict"] is None:
            check(got is None, where)
            continue
        near = lambda a, b: (a is None) == (b is None) and (a is None or abs(a - b) < 2e-5)
        check(near(got["p"], cell["p_go"]), "P(go): " + where)
        check(near(got["w"], cell["p_worst"]) and near(got["b"], cell["p_best"]), "worst and best: " + where)
        at_a_threshold = cell["p_go"] is not None and min(abs(cell["p_go"] - t) for t in (0.5, 0.8)) < 2e-5
        check(at_a_threshold or (got["v"] == cell["verdict"] and got["r"] == cell["reason"]), "class: " + where)


def check_click(browser, expected, columns):
    cell = next(c for c in expected["cells"] if c["p_go"] is not None)
    browser.click(*screen_position(browser, cell["row"] * columns + cell["column"]))
    text = browser.js("document.getElementById('cell').innerText")
    check(f"{cell['p_go']:.3f}" in text, f"a click shows P(go) {cell['p_go']:.4f}: {text!r}")
    for part in ("Slope", "Soil", "What the model does not know", "By heading"):
        check(part in text, f"the panel of a cell says {part}")
    check(browser.js("document.getElementById('pane-cell').hidden") is False, "a click opens the panel of the cell")


def check_layers(browser):
    seen = set()
    browser.js("document.getElementById('tab-layers').click()")
    for name in browser.js("layers.map((l) => l.id)"):
        browser.js(f"document.querySelector('input[name=layer][value={name}]').click()")
        browser.settle()
        seen.add(browser.js("picture.toDataURL()"))
        check(browser.js("document.getElementById('legend').innerText.length > 3"), f"layer {name} has a legend")
    check(len(seen) >= 6, f"layers differ: {len(seen)} different pictures")
    browser.js("document.querySelector('input[name=layer][value=class]').click()")
    browser.settle()


def check_settings(browser):
    browser.js("document.getElementById('tab-layers').click()")
    before = browser.js("document.querySelector('.share-list').innerText")
    browser.js("(() => { const e = document.getElementById('go'); e.value = 99; e.dispatchEvent(new Event('input')); })()")
    browser.settle()
    check(browser.js("document.querySelector('.share-list').innerText") != before, "the threshold changes the shares")
    browser.js("document.getElementById('reset').click()")
    browser.settle()
    check(browser.js("document.querySelector('.share-list').innerText") == before, "the study's thresholds come back")
    uphill = browser.js("picture.toDataURL()")
    browser.js("document.getElementById('dial').focus()")
    for _ in range(9):
        browser.key("ArrowRight")
    check(browser.js("state.heading") == 45 and browser.js("state.mode") == "set", "arrow keys turn the dial")
    check(browser.js("picture.toDataURL()") != uphill, "a heading changes the picture")
    colours = browser.js("getComputedStyle(document.documentElement).getPropertyValue('--v3')")
    browser.js("document.getElementById('palette').click()")
    check(browser.js("getComputedStyle(document.documentElement).getPropertyValue('--v3')") != colours, "safe colours")
    browser.js("document.getElementById('palette').click(); state.mode = 'uphill'; refresh()")
    browser.settle()


def check_keyboard(browser):
    browser.js("canvas.focus()")
    browser.key("0", "0")
    for _ in range(3):
        browser.key("ArrowRight")
    browser.key("Enter", "\r")
    check(browser.js("view.chosen !== null && view.chosen === view.cross"), "Enter asks about the cell at the crosshair")
    order = browser.js("[...document.querySelectorAll('button, input, canvas, [tabindex]')].filter((e) => e.tabIndex >= 0"
                       " && e.offsetParent !== null).length")
    check(order >= 7, "controls are in the order of the Tab key")


def check_route(browser, expected):
    wanted = expected["route"]
    browser.js("document.getElementById('route-draw').click()")
    for cell in (wanted["start"], wanted["end"]):
        browser.click(*screen_position(browser, cell))
    check(browser.js("route.path[0]") == wanted["start"] and browser.js("route.path.at(-1)") == wanted["end"],
          "a route runs between the two clicks")
    for name, kind in (("shortest", "length"), ("safest", "risk"), ("fastest", "time")):
        if wanted.get(name) is None:
            continue
        cost = browser.js(f"(() => {{ route.cost = '{kind}'; return find_route().cost; }})()")
        # The page stores P(go) in 16 bits, which shows in -ln P(go) near 1, and speeds in steps of 0.01 km/h.
        near = {"risk": 1e-2, "time": 2e-4, "length": 1e-5}[kind]
        check(abs(cost - wanted[name]) < near * wanted[name], f"{name}: page {cost}, program {wanted[name]}")
        chance = browser.js("route.drive.chance")  # 16 points of each soil, 200 draws
        check(abs(chance - wanted[name + " chance"]) < 0.12, f"{name}: chance {chance}, program {wanted[name + ' chance']}")
    text = browser.js("document.getElementById('route').innerText")
    check("Length on the ground" in text and "Chance to get through" in text and "Places where one gets stuck" in text, f"the route tells its totals: {text!r}")
    check(browser.js("route.path.every((c) => [1, 2].includes(answer_of(c, 'best').verdict))"),
          "a route keeps to cells that some heading passes")


def check_route_tools(browser):
    """With a route drawn: shares follow the thresholds, lines of equal cost, files, measuring, and the address."""
    shares = lambda: browser.js("document.querySelector('.share-list').innerText")
    before = shares()
    browser.js("(() => { const e = document.getElementById('go'); e.value = 99; e.dispatchEvent(new Event('input')); })()")
    browser.settle()
    check(shares() != before, "shares follow the thresholds while a route is drawn")
    browser.js("document.getElementById('reset').click()")
    browser.settle()
    check(shares() == before and browser.js("route.path !== null"), "shares and route come back")
    gpx = ElementTree.fromstring(browser.js("route_gpx()"))
    points = gpx.findall(".//{*}trkpt")
    check(len(points) == browser.js("route.path.length"), "a GPX holds every cell of the route")
    start = browser.js("degrees_of(...centre_of(route.start))")
    check(abs(float(points[0].get("lon")) - start[0]) < 1e-6 and abs(float(points[0].get("lat")) - start[1]) < 1e-6,
          "a GPX starts at the start")
    line = json.loads(browser.js("route_geojson()"))["features"][0]
    check(len(line["geometry"]["coordinates"]) == len(points) and line["properties"]["length_m"] > 0, "so does GeoJSON")
    check(browser.js("mgrs_of(44.4, 33.3)") == "38SMB 44140 84706", "MGRS as GeographicLib gives it")
    browser.js("document.getElementById('route-reach').click()")
    browser.settle()
    check(browser.js("bands.labels.length > 0") and "every " in browser.js("document.getElementById('legend').innerText"),
          "the reachable area has lines of equal cost")
    browser.js("show_readout(route.start)")
    check(browser.js("document.getElementById('readout').getBoundingClientRect().top"
                     " >= canvas.getBoundingClientRect().bottom"), "the readout covers nothing of the map")
    check("From A" in browser.js("document.getElementById('readout').innerText"), "the readout tells what a cell costs from the start")
    browser.js("toggle_measure(); add_measured(0); add_measured(cells.columns - 1)")
    check("in all" in browser.js("document.getElementById('measured').textContent"), "measuring tells a length")
    browser.js("toggle_measure()")
    browser.until("location.hash.includes('reach=1')")
    kept = browser.js("[route.start, route.end, state.layer, route.reaching]")
    address = browser.js("location.hash")
    browser.js("document.getElementById('route-clear').click()")
    browser.until("!location.hash.includes('reach=1')")
    check("From A" not in browser.js("document.getElementById('readout').innerText"), "and no longer when the route is cleared")
    browser.js(f"location.hash = {json.dumps(address)}")
    browser.until("route.reaching")
    check(browser.js("[route.start, route.end, state.layer, route.reaching]") == kept, "the address brings the state back")
    browser.js("document.getElementById('route-clear').click()")
    browser.settle()


def check_hostile(browser, expected):
    check(browser.js("document.getElementById('title').textContent") == expected["title"], "the title shows as text")
    check(browser.js("window.broken === undefined"), "no script of the metadata ran")
    browser.js("document.getElementById('about').click()")
    check(browser.js("document.querySelectorAll('#about-text script, #about-text img, #title *').length") == 0,
          "metadata makes no elements")
    browser.js("document.getElementById('about-box').close()")


def check_print(browser):
    """On paper: the map with its legend and what a reader must know, even from a dark screen; no controls."""
    browser.js("set_theme('dark'); window.dispatchEvent(new Event('beforeprint'))")
    browser.call("Emulation.setEmulatedMedia", media="print")
    shown = lambda name: browser.js(f"getComputedStyle(document.querySelector('{name}')).display !== 'none'")
    check(all(shown(name) for name in ("#title", "#canvas", "#legend", "#scale", "#print-note")), "map and legend are printed")
    check(not any(shown(name) for name in (".panel", ".tools", ".zoom")), "controls are not printed")
    text = browser.js("document.getElementById('print-note').innerText")
    for verdict in browser.js("meta.verdicts.map((v) => v.label)"):
        check(verdict in text, f"the printed note tells the share of {verdict}: {text!r}")
    check("hash" not in text, "paper holds no hashes")
    check(browser.js("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)", "paper is white")
    browser.call("Emulation.setEmulatedMedia", media="")
    browser.js("set_theme('light')")


def check_shares(browser):
    rows = browser.js("(() => { const { count } = count_classes(), s = [...document.querySelectorAll('.share-list span')]"
                      ".map((e) => e.textContent); return meta.verdicts.map((v, i) => [count.get(v.code), s[3 * i + 1]]); })()")
    for count, text in rows:
        check((count == 0) == (text == "0.0 %"), f"{count} cells are told as {text}")


def check_phone(browser):
    check(browser.js("document.documentElement.scrollWidth <= innerWidth"), "nothing is wider than the phone")
    small = browser.js("[...document.querySelectorAll('button, .layers label, .segments label')].filter((e) =>"
                       " e.offsetParent && e.offsetHeight < 26).map((e) => e.textContent)")
    check(not small, f"buttons are large enough for a finger: {small}")
    check(browser.js("['title', 'subtitle'].every((id) => { const e = document.getElementById(id);"
                     " return e.scrollWidth <= e.clientWidth + 1; })"), "title and subtitle go on in a second line")
    check(browser.js("canvas.clientHeight > 0.35 * innerHeight"), "the map keeps room")


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    pictures = pathlib.Path(sys.argv[3]) if len(sys.argv) > 3 else None
    expected = json.loads((folder / "expected.json").read_text())
    address = (folder / "index.html").as_uri()
    browser = Browser(program, 1280, 800)
    browser.open(address)
    columns = browser.js("cells.columns")
    check_hostile(browser, expected)
    check_cells(browser, expected, columns)
    if pictures:
        browser.picture(pictures / "desktop.png")
    check_layers(browser)
    check_click(browser, expected, columns)
    check_settings(browser)
    check_keyboard(browser)
    check_route(browser, expected)
    check_route_tools(browser)
    check_shares(browser)
    check_print(browser)
    if pictures:
        browser.picture(pictures / "route.png")
    check(not browser.complaints(), f"no error: {browser.complaints()[:2]}")
    check(browser.requests() == [address], f"nothing but the file itself is fetched: {browser.requests()}")
    browser.close()
    phone = Browser(program, 390, 844, mobile=True, dark=True)
    phone.open(address)
    check(phone.js("document.documentElement.dataset.theme") == "dark", "a dark screen gets the dark page")
    check_phone(phone)
    if pictures:
        phone.picture(pictures / "phone.png")
    check_route(phone, expected)
    if pictures:
        phone.picture(pictures / "phone_route.png")
    check_route_tools(phone)
    check_phone(phone)
    check(not phone.complaints(), f"no error on the phone: {phone.complaints()[:2]}")
    phone.close()
    print(f"{checks.passed} checks passed")


main()
