"""Learn the skills of infants at several ages, and ship movements or policies, and success by age.

    python sculpt/make_skills.py --ship [SKILL ...]                         (an hour or two, by searches)
    python sculpt/make_skills.py --device cuda:0 --steps 3000000 [SKILL ...] (minutes for each skill, by trainings)

What was learnt before is kept in the folder `-o`, by default out/skills, so that the same command goes on. The page
index.html there shows success by age; with `--ship`, results and what has the skill go into the package.
"""

import argparse
import json
import os
import shutil
import time
from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import Any

from mimoc.policies.skill import KINDS, SHIPPED
from mimoc.render.plots import write_sheet
from mimoc.schema.kinds import SKILLS
from mimoc.studies.skills import LEARNT, RESULTS, SkillReport, learn_skill, skill_sheet

SEARCHED: Mapping[str, tuple[float, ...]] = {"roll": (2, 4, 6, 8), "grasp": (2, 4, 6, 9)}
"""Skills that a search without feedback can find, and the ages at which it is tried."""
TRAINED: Mapping[str, tuple[float, ...]] = {
    "roll": (2, 3, 4, 6, 9),
    "sit_up": (4, 6, 8, 10, 12),
    "sit": (2, 4, 6, 8, 10),
    "crawl": (3, 5, 7, 9, 12),
    "pull_to_stand": (4, 6, 8, 10, 12),
    "stand": (5, 8, 11, 14, 18),
    "cruise": (5, 7, 9, 12, 15),
    "walk": (6, 9, 12, 15, 18),
    "grasp": (2, 4, 6, 9, 12),
}
TRAINED_OPTIONS: Mapping[str, Mapping[str, Any]] = {"crawl": {"style": "hands_and_knees"}}
"""Keys of the task in trainings; searches have those that it has anyway, such as crawling on the belly."""


def learn(skill: str, out: Path, device: str, steps: int) -> SkillReport:
    """Learn a skill, and draw when it is there."""
    ages = (SEARCHED if device == "cpu" else TRAINED)[skill]
    started_s = time.monotonic()

    def show(done: int, total: int) -> None:
        print(f"{skill}: {done} of {total}, {time.monotonic() - started_s:.0f} s", flush=True)

    options, cores = None if device == "cpu" else TRAINED_OPTIONS.get(skill), os.cpu_count() or 1
    budget = {"device": device, "steps": steps, "seeds": 2 if device == "cpu" else 1, "processes": cores}
    report = learn_skill(skill, ages, out / skill, options=options, progress=show, **budget)
    write_sheet(skill_sheet(report), out / skill / "success.png")
    print(skill, report.from_months, report.verdict, [round(result.success, 2) for result in report.ages])
    return report


def ship(report: SkillReport, out: Path) -> None:
    """Copy results, and the movements or policies that have the skill, into the package, instead of older ones."""
    text = json.dumps(report.to_data(), indent=1, sort_keys=True)
    (RESULTS / f"{report.skill}.json").write_text(f"{text}\n", encoding="utf-8")
    for result in report.ages:
        for name in (f"{report.skill}_{result.age_months:g}_months{kind}" for kind in KINDS):
            (SHIPPED / name).unlink(missing_ok=True)
            if result.best.success >= LEARNT and (made := out / report.skill / name).exists():
                shutil.copy(made, SHIPPED / name)


def write_page(reports: list[SkillReport], out: Path, device: str) -> None:
    """Write a page with success by age of each skill."""
    parts = [f"<!doctype html><meta charset=utf-8><title>Skills</title><h1>Skills learnt on {escape(device)}</h1>"]
    for report in reports:
        name = report.skill.replace("_", " ")
        since = "not at these ages" if report.from_months is None else f"from {report.from_months:.1f} months on"
        parts.append(f"<h2>{name}: {since} ({report.verdict})</h2><img src='{report.skill}/success.png' width=700>")
    (out / "index.html").write_text("\n".join(parts) + "\n", encoding="utf-8")
    print(out / "index.html")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("skills", nargs="*", metavar="SKILL", choices=(*SKILLS, []))
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--steps", type=int, default=3_000_000)
    parser.add_argument("--ship", action="store_true")
    parser.add_argument("-o", "--out", type=Path, default=Path("out/skills"))
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    wanted = asked.skills or (SEARCHED if asked.device == "cpu" else TRAINED)
    learnt = [learn(name, asked.out, asked.device, asked.steps) for name in wanted]
    if asked.ship:
        for each in learnt:
            ship(each, asked.out)
    write_page(learnt, asked.out, asked.device)
