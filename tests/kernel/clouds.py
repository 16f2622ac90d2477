"""Flexible bodies of point masses whose modes have no structure, so that their integrals are dense, in chains."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import derive
from derive.ir.kernel import Kernel
from derive.ir.lanes import section_in_lanes
from derive.ir.loop_nests import Node
from derive.ir.tiles import in_tiles, kept_in_tiles, numbers_of_instances, tiled, with_kept_in_tiles
from derive.spec.toml.read import parse

MODES, NODES = 6, 9


def write_cloud(path: Path, seed: int, nodes: int, modes: int) -> None:
    """Write a file with such a body."""
    rng = np.random.default_rng(seed)
    index = np.arange(nodes, dtype=np.int32)
    np.savez(
        path,
        positions=rng.uniform(-0.3, 0.3, (nodes, 3)),
        mass_row=index,
        mass_col=index,
        mass_value=rng.uniform(0.5, 1.5, nodes) / nodes,
        modes=rng.uniform(-1, 1, (modes, nodes, 3)),
        modal_stiffness=rng.uniform(50, 100, modes),
    )


@cache
def chain(count: int, kinds: tuple[str, ...], alike: bool = False) -> derive.SpatialScene:
    """A chain of flexible bodies that hangs from the ground, with joints of these kinds in turn; all alike or none."""
    turned = "rotation = { x = [0, 0, 1], z = [0, 1, 0] }"
    parts = [
        'name = "clouds"',
        '[scene]\ngravity = [0.3, 0, -9.81]\nlowering = "instances"',
        f"[ground.markers]\no = {{ at = [0.1, -0.2, 0.3], {turned} }}",
    ]
    with TemporaryDirectory() as folder:
        for k in range(count):
            file = Path(folder) / f"cloud_{0 if alike else k}.npz"
            write_cloud(file, 0 if alike else k, NODES, MODES)
            parts.append(
                f'[bodies.link{k}]\nnodes = "{file}"\nunits = "SI"\nmarkers = {{ left = {{ nodes = [0, 1, 2] }}, '
                f"right = {{ nodes = [6, 7, 8], {turned} }} }}"
            )
            end, kind = f"link{k - 1}.right" if k else "ground.o", kinds[k % len(kinds)]
            parts.append(f'[joints.joint{k}]\nkind = "{kind}"\nbetween = ["{end}", "link{k}.left"]')
        return parse("\n".join(parts))


def state(kernel: Kernel) -> dict[str, list[float] | float]:
    rng = np.random.default_rng(3)
    return {a.name: 0.3 if a.scalar else rng.uniform(-0.3, 0.3, a.size).tolist() for a in kernel.arguments}


def in_blocks(kernel: Kernel) -> tuple[Kernel, list[Node]]:
    """A kernel with the tiles of its numbers, and its statements as they are printed."""
    tables = numbers_of_instances(kernel.constants)
    every_section = (nodes for section in kernel.sections for _, nodes in section_in_lanes(section.body))
    nodes = [in_tiles(node, tables) for part in every_section for node in part]
    kept = kept_in_tiles(nodes, ())
    nodes = [with_kept_in_tiles(node, kept) for node in nodes]
    return replace(kernel, constants=(*kernel.constants, *map(tiled, tables.values()))), nodes
