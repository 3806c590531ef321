"""A worker process of gonogo.Campaign: python -m gonogo.worker <study> [options]. Campaigns start it."""
import argparse

from . import _core


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m gonogo.worker")
    parser.add_argument("study")
    parser.add_argument("--device", default="cpu", choices=["cpu", "cuda"])
    parser.add_argument("--places", type=int, default=1)
    parser.add_argument("--gpu", type=int, default=0)
    parser.add_argument("--checkpoints", default="")
    parser.add_argument("--checkpoint-every", type=float, default=30.0)
    parser.add_argument("--courses", default="")
    parser.add_argument("--course-every", type=float, default=0.05)
    given = parser.parse_args()
    _core.run_worker(given.study, given.device, given.places, given.gpu, given.checkpoints, given.checkpoint_every,
                     given.courses, given.course_every)


if __name__ == "__main__":
    main()
