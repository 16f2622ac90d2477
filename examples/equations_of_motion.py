"""Print the equations of motion of a beam and read coefficients from them.

The equations are SymPy expressions whose sums over the modes are kept; `expanded()` writes them out. The script prints
those of the free beam of the paper in both frames. The numbers are the coefficients of the stiffness terms in EI/l^3:
64 and 192 in the frame of the midpoint (33), 144 and 1200 in the mean frame (41).
"""

import derive


def main() -> dict[str, list[float]]:
    """Return the stiffness of both modes in EI/l^3 by frame."""
    result = {}
    for frame in (derive.Frame("point", at=0), derive.Frame("mean")):
        equations = derive.derive(derive.planar_beam("beam", frame=frame))
        print(equations, end="\n\n")
        result[frame.kind] = []
        for mode in ("alpha1", "alpha2"):
            row = equations.expanded().row(mode)
            values = {symbol: 1 if str(symbol) in ("EI", "l", mode) else 0 for symbol in row.free_symbols}
            result[frame.kind].append(float(row.subs(values)))
            print(f"{mode}: 0 = {row}")
    return result


if __name__ == "__main__":
    main()
