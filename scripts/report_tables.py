"""Tables of docs/report.md from what scripts/report.py left in its folder."""
import csv, json, statistics


def folder_name(name):
    return name.replace(",", "").replace(" ", "_")


class Tables:
    def __init__(self, out, variables, outcomes, samplers):
        self.out, self.variables, self.outcomes, self.samplers = out, variables, outcomes, samplers

    def text(self):
        parts = [self.boundary_table(), self.measure_table(), self.cohesion_table(), self.curve_table(), self.sampler_table()]
        return "\n\n".join("\n".join(part) for part in parts) + "\n"

    def measure_table(self):
        known = self.forecasts("nothing")
        yield "| not known | mean square change of P(go) | other side of 0.5 |"
        yield "|---|---|---|"
        rows = []
        for name in self.variables:
            p = self.forecasts(name)
            rows.append((statistics.mean((a - b) ** 2 for a, b in zip(known, p)),
                         statistics.mean((a > 0.5) != (b > 0.5) for a, b in zip(known, p)), name))
        for square, flips, name in sorted(rows, reverse=True):
            yield f"| {name.replace('_', ' ')} | {square:.4f} | {100 * flips:.1f} % |"

    def boundary_table(self):
        """Share of the trials that pass, by slope and cohesion, and what ends the others."""
        with open(self.out / "measure" / "trials.csv") as file:
            trials = list(csv.DictReader(file))
        bands = [(0, 3), (3, 8), (8, 15)]
        yield "| slope along [deg] | " + " | ".join(f"passes, cohesion {a} to {b} kPa" for a, b in bands) + \
            " | of the others: too slow | traction or power | slid back |"
        yield "|---|" + "---|" * (len(bands) + 3)
        for low in (-10, 0, 10, 20, 30):
            here = [t for t in trials if low <= float(t["slope_along"]) < low + (5 if low == 30 else 10)]
            cells = []
            for a, b in bands:
                band = [t for t in here if a <= float(t["cohesion"]) < b]
                cells.append(f"{statistics.mean(t['verdict'] != 'no_go' for t in band):.2f} of {len(band)}")
            stopped = [t["reason"] for t in here if t["verdict"] == "no_go"]
            for reasons in (("timeout",), ("traction", "power"), ("slid_back",)):
                cells.append(str(sum(r in reasons for r in stopped)))
            yield f"| {low} to {low + (5 if low == 30 else 10)} | " + " | ".join(cells) + " |"

    def cohesion_table(self):
        yield "| the vehicle | cohesion: mean | 5 % | 95 % |"
        yield "|---|---|---|---|"
        for outcome in self.outcomes:
            text = (self.out / "measure" / f"cohesion_after_{outcome.replace('/', '_')}.txt").read_text().splitlines()[-1]
            found = json.loads(text)["reconstruction"]["cohesion"]
            yield f"| {outcome} | {found['mean']:.1f} | {found['low']:.1f} | {found['high']:.1f} |"

    def forecasts(self, hidden):
        with open(self.out / "measure" / f"{hidden}.csv") as file:
            return [float(row["p_go"]) for row in csv.DictReader(file)]

    def means(self, folder):
        """Mean Brier score and log loss of the model and its baselines, by number of trials."""
        found = {}
        with open(self.out / folder / "learning_curve.csv") as file:
            for row in csv.DictReader(file):
                of = found.setdefault(int(row["trials"]), {}).setdefault(row["forecaster"], ([], []))
                of[0].append(float(row["brier"]))
                of[1].append(float(row["log_loss_nat"]))
        return {trials: {name: [statistics.mean(x) for x in of] for name, of in by_name.items()}
                for trials, by_name in found.items()}

    def curve_table(self):
        sobol, active = self.means("curve"), self.means("curve_active")
        names = ["model", "gaussian_process", "quadratic_logistic", "neural_network", "logistic_regression"]
        yield "| trials | " + " | ".join(n.replace("_", " ") for n in names) + " | model, active | process, active |"
        yield "|---|" + "---|" * (len(names) + 2)
        for trials, scores in sobol.items():
            cells = [f"{scores[n][0]:.4f}" for n in names]
            cells += [f"{active[trials][n][0]:.4f}" for n in ("model", "gaussian_process")]
            yield f"| {trials} | " + " | ".join(cells) + " |"

    def sampler_table(self):
        yield "| negative phase | Brier score | log loss [nat] |"
        yield "|---|---|---|"
        for name in self.samplers:
            brier, loss = self.means(f"samplers/{folder_name(name)}")[200]["model"]
            yield f"| {name} | {brier:.4f} | {loss:.4f} |"
