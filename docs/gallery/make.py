#!/usr/bin/env python3
"""Pictures of maps' pages: docs/gallery/make.py <map folder> [<browser> [<map folder of the second region>]].
Ends with scripts/shrink_pictures.sh, which makes each at most 250 kB. Needs Python, headless Chromium, ffmpeg and
pngquant."""
import pathlib
import subprocess
import sys

here = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(here.parents[1] / "tests" / "page"))
from browser import Browser  # noqa: E402

page = (pathlib.Path(sys.argv[1]).resolve() / "index.html").as_uri()
program = sys.argv[2] if len(sys.argv) > 2 else "chromium-headless-shell"

route = Browser(program, 1280, 800)
route.open(page)
route.js("state.mode = 'worst'; refresh(); draw_route()")
route.click(640, 560)
route.click(560, 110)
route.picture(here.parent / "images" / "page.png")
route.close()

cell = Browser(program, 1280, 800, dark=True)
cell.open(page)
cell.js("document.querySelector('input[name=layer][value=p_go]').click(); set_heading(60)")
cell.click(890, 600)
cell.picture(here / "cell_dark.png")
cell.close()

soft = Browser(program, 1280, 800)
soft.open(page)
soft.js("document.querySelector('input[name=layer][value=reason]').click()")
soft.click(880, 240)
soft.picture(here / "soft_soil.png")
soft.close()

phone = Browser(program, 390, 844, mobile=True)
phone.open(page)
phone.js("document.getElementById('palette').click()")
phone.picture(here / "phone.png")
phone.close()

if len(sys.argv) > 3:
    second = Browser(program, 1280, 800)
    second.open((pathlib.Path(sys.argv[3]).resolve() / "index.html").as_uri())
    second.js("document.querySelector('input[name=layer][value=reason]').click()")
    second.picture(here / "zion_reasons.png")
    second.close()

shrink = here.parents[1] / "scripts" / "shrink_pictures.sh"
subprocess.run([shrink, here.parent / "images" / "page.png", *sorted(here.glob("*.png"))], check=True)
