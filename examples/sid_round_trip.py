"""Exchange a flexible body with other multibody programs.

Standard input data (SID) is a text format for the shape integrals of a flexible body. The script writes the block of
scenes/block.toml as SID, reads the text back, and evaluates both bodies in the same state. The number is the largest
relative difference of their accelerations: exactly zero, since the text holds all digits.
"""

from pathlib import Path

import numpy as np

import derive
import derive.sid

BLOCK = Path(__file__).parent.parent / "scenes" / "block.npz"


def main() -> float:
    """Return the largest relative difference of the accelerations."""
    body = derive.modal(derive.nodal_body("sid_block", str(BLOCK), units="SI", modes=4))
    text = derive.sid.write(body)
    random = np.random.default_rng(1)
    q = np.concatenate([[0, 0, 0, 0.8, 0, 0.6, 0], 1e-4 * random.standard_normal(4)])
    v = random.standard_normal(10)
    results = []
    for each in (body, derive.sid.read(text)):
        model = derive.lower(derive.derive_modal(each))
        k = derive.interpret(model.kernel("setup"), {"p": []})["k"]
        results.append(np.array(derive.interpret(model.kernel("mass_force"), {"t": 0.0, "q": q, "v": v, "k": k})["h"]))
    print(f"{len(text.splitlines())} lines of SID for a body with 4 modes")
    return float(np.abs(results[0] - results[1]).max() / np.abs(results[0]).max())


if __name__ == "__main__":
    main()
