"""Run the corpus: every command and the physics on the scenes of many seeds, in parallel and resumable.

    python tests/corpus/run.py --seeds 0:2000 --jobs 2 --store corpus.jsonl

The store has a line for each finished seed; seeds that it has are not run again. A process of a job that dies, or that
takes more than LIMIT for a scene, is a finding, and the next seeds go on. `--summary` prints what a store has found.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
import traceback
from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
BLOCK = 20
LIMIT = 900
"""The longest time of a scene on a processor of its own, s."""


def run() -> int:
    """Run the seeds that are missing, then print the summary; the exit code is 1 if there are findings."""
    options = _options()
    if options.worker:
        _work(options.worker, options.store)
        return 0
    done = {result["seed"] for result in _results(options.store)}
    seeds = [seed for seed in range(*options.seeds) if seed not in done]
    if not options.summary:
        blocks = [seeds[i : i + BLOCK] for i in range(0, len(seeds), BLOCK)]
        with ThreadPoolExecutor(options.jobs) as pool:
            list(pool.map(lambda block: _block(block, options.store), blocks))
    results = [result for result in _results(options.store) if result["seed"] in range(*options.seeds)]
    print(summary(results))
    return int(any(result["findings"] for result in results))


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--seeds", type=_range, default=(0, 2000), help="first seed, and the one behind the last: 0:2000"
    )
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--store", type=Path, default=Path("corpus.jsonl"))
    parser.add_argument("--summary", action="store_true", help="print what the store has, and run nothing")
    parser.add_argument("--worker", type=lambda text: [int(seed) for seed in text.split(",")], help=argparse.SUPPRESS)
    return parser.parse_args()


def _range(text: str) -> tuple[int, int]:
    first, last = text.split(":")
    return int(first), int(last)


def _results(store: Path) -> list[dict[str, Any]]:
    """The results of a store, without a line that was cut off."""
    results = []
    for line in store.read_text().splitlines() if store.exists() else []:
        try:
            results.append(json.loads(line))
        except json.JSONDecodeError:
            continue
    return results


def _block(seeds: list[int], store: Path) -> None:
    """Run seeds in processes of their own, each until it dies."""
    rest = list(seeds)
    while rest:
        began = time.monotonic()
        command = [sys.executable, __file__, "--store", str(store), "--worker", ",".join(map(str, rest))]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        try:
            _, error = process.communicate(timeout=limit(len(rest)))
        except subprocess.TimeoutExpired:
            process.kill()
            _, error = process.communicate()
        done = {result["seed"] for result in _results(store)}
        left = [seed for seed in rest if seed not in done]
        if left:  # the first one has killed the process
            text = f"exit code {process.returncode} after {time.monotonic() - began:.0f} s\n{error[-1000:]}"
            _append(store, _failed(left[0], "process", "the process died", text))
        rest = left[1:]


def limit(scenes: int) -> float:
    """The longest time (s) of scenes on this machine, where other processes wait for its processors as well."""
    return LIMIT * scenes * max(1.0, os.getloadavg()[0] / (os.cpu_count() or 1))


def _append(store: Path, result: dict[str, Any]) -> None:
    with store.open("a") as file:
        file.write(json.dumps(result) + "\n")


def _failed(seed: int, command: str, cause: str, text: str) -> dict[str, Any]:
    finding = {"command": command, "cause": cause, "text": text}
    return {"seed": seed, "linkage": "", "findings": [finding], "refusals": {}, "seconds": {}}


def _work(seeds: list[int], store: Path) -> None:
    """Check scenes, one after the other, with a cache that no one else uses."""
    sys.path.insert(0, str(HERE.parent))
    with tempfile.TemporaryDirectory(prefix="corpus-cache-") as folder:
        os.environ["XDG_CACHE_HOME"] = folder
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # threads are for larger matrices, and other jobs run
        for variable in ("ZIG_GLOBAL_CACHE_DIR", "MPLCONFIGDIR"):  # caches of others, which blocks share
            os.environ.setdefault(variable, str(Path(tempfile.gettempdir()) / f"corpus-{variable.lower()}"))
        import matplotlib.font_manager  # noqa: F401  # tells of its cache while it builds that, and then no more

        from corpus.scene_check import check_scene, quick_compiler

        os.environ["CC"] = quick_compiler(Path(folder))
        for seed in seeds:
            try:
                _append(store, check_scene(seed).data)
            except Exception as failure:
                _append(
                    store, _failed(seed, "the harness", f"{type(failure).__name__}: {failure}", traceback.format_exc())
                )


def summary(results: list[dict[str, Any]]) -> str:
    """The findings, grouped by command and cause; how long commands took, and what they refused."""
    groups: dict[tuple[str, str], list[int]] = defaultdict(list)
    times: dict[str, list[float]] = defaultdict(list)
    refused: dict[str, int] = defaultdict(int)
    for result in results:
        for finding in result["findings"]:
            groups[finding["command"], finding["cause"]].append(result["seed"])
        for command, seconds in result["seconds"].items():
            times[command].append(seconds)
        for pattern in result["refusals"].values():
            refused[pattern] += 1
    total = sum(sum(of) for of in times.values())
    clean = sum(not result["findings"] for result in results)
    lines = [f"{len(results)} scenes, {clean} without findings, {total / max(1, len(results)):.1f} CPU s each"]
    for (command, cause), seeds in sorted(groups.items(), key=lambda group: -len(group[1])):
        some = ", ".join(map(str, seeds[:6])) + (", ..." if len(seeds) > 6 else "")
        lines.append(f"  {len(seeds):4d}  {command}: {cause}  (seeds {some})")
    lines.append("refusals that are legitimate:")
    lines += [f"  {count:4d}  {pattern}" for pattern, count in sorted(refused.items(), key=lambda item: -item[1])]
    lines.append("CPU seconds: mean, runs")
    lines += [f"  {sum(of) / len(of):6.2f}  {len(of):4d}  {command}" for command, of in sorted(times.items())]
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(run())
