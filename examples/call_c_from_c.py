"""Call the generated C from a C program.

The generated files have no dependencies but the mathematical library. This script writes them and a small program,
compiles both with the C compiler of this machine, and runs the program. docs/tutorial_c.md explains the calls. The
number is the acceleration of the first mode: -144 EI/l^3 alpha1 / (m/5) = -720 alpha1 for a beam at rest.
"""

import subprocess
import tempfile
from pathlib import Path

import derive

PROGRAM = """
#include "call_from_c.h"
#include <stdio.h>

int main(void)
{
    double p[CALL_FROM_C_NP], k[CALL_FROM_C_NK], vdot[CALL_FROM_C_NV];
    const double q[CALL_FROM_C_NQ] = {0.0, 0.0, 0.0, 0.01, 0.0};
    const double v[CALL_FROM_C_NV] = {0.0, 0.0, 0.0, 0.0, 0.0};

    call_from_c_defaults(p);
    if (call_from_c_setup(p, k) != 0 || call_from_c_accel(0.0, q, v, k, vdot) != 0)
        return 1;
    printf("%.17g\\n", vdot[3]);
    return 0;
}
"""


def main() -> float:
    """Return the acceleration that the C program prints."""
    beam = derive.planar_beam("call_from_c")
    files = derive.model_files(derive.lower(derive.derive(beam)), beam)
    with tempfile.TemporaryDirectory() as folder:
        derive.write(files, folder)
        model = Path(folder) / "call_from_c"
        (model / "main.c").write_text(PROGRAM)
        subprocess.run(["cc", "-std=c99", "-O2", "main.c", "call_from_c.c", "-lm", "-o", "main"], cwd=model, check=True)
        output = subprocess.run([model / "main"], capture_output=True, text=True, check=True).stdout
    print(f"acceleration of alpha1: {output.strip()} m/s^2")
    return float(output)


if __name__ == "__main__":
    main()
