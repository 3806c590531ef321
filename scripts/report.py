#!/usr/bin/env python3
"""Everything that docs/report.md shows: pictures and tables of the HMMWV's 2,074 older trials and their model.

  scripts/report.py                        # all parts, 40 minutes on two cores
  scripts/report.py maps route pictures    # some of them

  plots      what decides, boundary plots with reasons
  scores     a model of all but 326 trials beside its baselines, with inputs hidden and reconstructed
  measure    P(go) where one variable is not known: what to measure first
  curve      scores over the number of trials, of the design's points and of points that an active design would take
  samplers   the same 200 trials with each negative phase and each sampler
  maps       two regions, dry and wet, and what the water changes
  route      a way over the first region, dry, and a picture of it
  pictures   the pictures of docs/report.md, each at most 250 kB
  tables     OUT/tables.md, the tables of docs/report.md

What is there already is kept; the same command goes on. Needs headless Chromium, ffmpeg and pngquant for pictures.
"""
import argparse, csv, json, pathlib, shutil, subprocess, sys

from report_tables import Tables, folder_name

HERE = pathlib.Path(__file__).resolve().parent.parent
DATASET = "data/hmmwv_32mm_unsolved/dataset.h5"
STUDY = HERE / "configs/studies/hmmwv_32mm.json"
SAGEHEN = HERE / "configs/regions/sagehen"
IMAGES = HERE / "docs/images/report"
WAY = ("221000,4368500", "216900,4372700")  # UTM 11N
VARIABLES = ["slope_along", "cohesion", "friction_angle", "tyre_friction", "slope_across", "commanded_speed", "bed_depth",
             "payload", "relative_density"]
SLOPES = (5, 25)  # uphill, where the verdict is open [deg]
STUCK = ["--set", "slope_along=12", "slope_across=0", "friction_angle=28", "relative_density=0.5", "payload=500",
         "tyre_friction=0.7", "bed_depth=0.2", "commanded_speed=2"]
OUTCOMES = ["go", "no_go/timeout"]
SUBSETS, HELD_OUT = "3", "500"

# What differs from the shipped study's section "learning". The larger share of the joint likelihood lets samplers matter.
SAMPLERS = {
    "exact sums": {"sampler": "exact"},
    "block Gibbs, persistent chains": {},
    "block Gibbs, contrastive (CD-1)": {"negative": "contrastive"},
    "block Gibbs, parallel tempering": {"negative": "tempering"},
    "block Gibbs, trajectory": {"negative": "trajectory"},
    "block Gibbs over code words": {"negative": "code_words"},
    "sampler tempering": {"sampler": "tempering"},
    "simulated annealing": {"sampler": "anneal"},
    "population annealing": {"sampler": "population"},
}


class Report:
    def __init__(self, gonogo, out):
        self.gonogo, self.out = gonogo, out

    def run(self, *words, result=None, log=None):
        """Runs a command unless its result is there; its output goes beside it, or into the log."""
        log = log or result.parent / (result.stem + ".txt")
        if (result or log).exists():
            return
        print("gonogo", *words, flush=True)
        done = subprocess.run([self.gonogo, *map(str, words)], stdout=subprocess.PIPE, text=True, cwd=HERE)
        if done.returncode != 0:
            sys.exit(f"gonogo {words[0]} ended with {done.returncode}")
        log.write_text(done.stdout)

    def model(self):
        """The model of these trials, for all parts."""
        file = self.out / "model/model.h5"
        self.run("train", "--dataset", DATASET, "--study", STUDY, "--out", file, result=file)
        return file

    def plots(self):
        folder = self.out / "plots"
        self.run("dataset", "plot", DATASET, "--by-reason", "--model", self.model(), "--out", folder, result=folder / "importance.png")
        folder = self.out / "cohesion"
        self.run("dataset", "plot", DATASET, "--by-reason", "--y", "cohesion", "--out", folder, result=folder / "boundary.png")

    def scores(self):
        folder = self.out / "validated"
        self.run("evaluate", "--model", self.model(), "--out", folder, result=folder / "evaluation.json")
        folder = self.out / "held"
        self.run("train", "--dataset", DATASET, "--study", STUDY, "--hold-out", 326, "--out", folder / "model.h5",
                 result=folder / "model.h5")
        self.run("evaluate", "--model", folder / "model.h5", "--dataset", DATASET, "--out", folder,
                 result=folder / "evaluation.json")

    def measure(self):
        """P(go) at the trials' points on slopes that decide, with each variable in turn not known."""
        folder = self.out / "measure"
        folder.mkdir(parents=True, exist_ok=True)
        self.run("dataset", "export", DATASET, "--format", "csv", "--out", folder / "trials.csv", result=folder / "trials.csv")
        with open(folder / "trials.csv") as file:
            points = [t for t in csv.DictReader(file) if SLOPES[0] <= float(t["slope_along"]) <= SLOPES[1]]
        for hidden in ["nothing", *VARIABLES]:
            asked = folder / f"{hidden}_asked.csv"
            with open(asked, "w", newline="") as file:
                writer = csv.writer(file, lineterminator="\n")
                writer.writerow(VARIABLES)
                writer.writerows(["" if v == hidden else t[v] for v in VARIABLES] for t in points)
            self.run("infer", "--model", self.model(), "--csv", asked, "--out", folder / f"{hidden}.csv", result=folder / f"{hidden}.csv")
        for outcome in OUTCOMES:
            name = outcome.replace("/", "_")
            self.run("infer", "--model", self.model(), *STUCK, "--outcome", outcome, "--reconstruct", "--json", result=None,
                     log=folder / f"cohesion_after_{name}.txt")

    def curve(self):
        for name, more in (("curve", []), ("curve_active", ["--active"])):
            folder = self.out / name
            self.run("learning-curve", "--dataset", DATASET, "--study", STUDY, "--trials", "50,100,300,1000", "--subsets",
                     SUBSETS, "--hold-out", HELD_OUT, "--out", folder, *more, result=folder / "learning_curve.csv")

    def samplers(self):
        for name, changes in SAMPLERS.items():
            folder = self.out / "samplers" / folder_name(name)
            folder.mkdir(parents=True, exist_ok=True)
            study = json.loads(STUDY.read_text())
            for section, key in ((study, "vehicle"), (study["soil"], "calibration"), (study, "region"), (study["map"], "cone_index_of")):
                section[key] = str((STUDY.parent / section[key]).resolve())
            study["learning"] |= {"generative": 0.05, "folds": 2, "epochs": 150, **changes}
            (folder / "study.json").write_text(json.dumps(study, indent=2) + "\n")
            self.run("learning-curve", "--dataset", DATASET, "--study", folder / "study.json", "--trials", 200, "--subsets", 1,
                     "--hold-out", HELD_OUT, "--out", folder, result=folder / "learning_curve.csv")

    def ground(self, region, moisture):
        """What the ground of a map is made of, as options of the program."""
        if region == "sagehen":
            return ["--dem", SAGEHEN / "elevation_10m.tif", "--soil", SAGEHEN / "usda_texture_30m.tif", "--moisture", moisture]
        file = self.out / f"{region}_{moisture}.json"
        content = json.loads((SAGEHEN.parent / f"{region}.json").read_text())
        for raster in content["rasters"]:
            for key in ("file", "files"):
                if key in raster:
                    raster[key] = ([str(SAGEHEN.parent / f) for f in raster[key]] if key == "files"
                                   else str(SAGEHEN.parent / raster[key]))
        for name in ("friction_angle", "cohesion", "relative_density"):
            del content["values"][name]
        content["soil"] = f"sandy loam, {moisture}"
        file.write_text(json.dumps(content, indent=2) + "\n")
        return ["--region", file]

    def maps(self):
        for region in ("sagehen", "zion"):
            for moisture in ("dry", "wet"):
                folder = self.out / f"{region}_{moisture}"
                self.run("map", "--model", self.model(), "--dataset", DATASET, *self.ground(region, moisture),
                         "--heading", "uphill", "--out", folder, result=folder / "map.json")
            folder = self.out / f"{region}_change"
            self.run("compare", self.out / f"{region}_dry", self.out / f"{region}_wet", "--out", folder,
                     result=folder / "compare.csv")

    def route(self):
        file = self.out / "way.geojson"
        self.run("route", "--model", self.model(), "--dataset", DATASET, *self.ground("sagehen", "dry"), "--from", WAY[0],
                 "--to", WAY[1], "--cost", "fastest,safest", "--out", file, result=file)
        sys.path.insert(0, str(HERE / "tests/page"))
        from browser import Browser
        page = Browser("chromium-headless-shell", 1280, 800)
        page.open((self.out / "sagehen_dry/index.html").as_uri())
        page.js("draw_route(); document.querySelector('input[name=cost][value=risk]').click()")
        for place in WAY:
            page.js(f"""(() => {{ const g = meta.grid, [e, n] = [{place}];
                const row = Math.floor((g.north - n) * g.metres_per_unit / cell_h);
                place_route_point(row * cells.columns + Math.floor((e - g.west) * g.metres_per_unit / cell_w)); }})()""")
        page.settle()
        page.picture(self.out / "way.png")
        page.close()

    def pictures(self):
        IMAGES.mkdir(parents=True, exist_ok=True)
        sources = {"importance": "plots/importance.png", "boundary": "plots/boundary.png", "cohesion": "cohesion/boundary.png",
                   "reliability": "validated/evaluation.png", "curve": "curve/learning_curve.png",
                   "way": "way.png",
                   **{f"{r}_{m}": f"{r}_{m}/map.png" for r in ("sagehen", "zion") for m in ("dry", "wet")}}
        for name, source in sources.items():
            if name.startswith("zion"):  # rugged: at the width of other maps it would not fit
                subprocess.run(["ffmpeg", "-loglevel", "error", "-y", "-i", self.out / source, "-vf", "scale=900:-1:flags=lanczos",
                                IMAGES / f"{name}.png"], check=True)
            else:
                shutil.copyfile(self.out / source, IMAGES / f"{name}.png")
        pictures = sorted(str(IMAGES / f"{name}.png") for name in sources)
        subprocess.run([HERE / "scripts/shrink_pictures.sh", *pictures], check=True)

    def tables(self):
        file = self.out / "tables.md"
        file.write_text(Tables(self.out, VARIABLES, OUTCOMES, SAMPLERS).text())
        print(file.read_text())


PARTS = ["plots", "scores", "measure", "curve", "samplers", "maps", "route", "pictures", "tables"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", choices=[[], *PARTS], default=[])
    parser.add_argument("--gonogo", default=str(HERE / "build/cpu-release/gonogo"))
    parser.add_argument("--out", type=pathlib.Path, default=HERE / "out/report")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    report = Report(options.gonogo, options.out.resolve())
    for part in options.parts or PARTS:
        getattr(report, part)()


if __name__ == "__main__":
    main()
