"""Tables on instances: one row for those that differ in their index alone."""

from derive.report.sections.instance_rows import merged_rows


def test_rows_that_differ_in_the_index_are_one() -> None:
    rows = [
        ["ground", "0"],
        *([f"weld[{i}]", f"link[{i}].right", f"link[{i + 1}].left", "ground.hook"] for i in range(5)),
    ]
    assert merged_rows(rows) == [
        ["ground", "0"],
        ["weld[i], i = 0 to 4", "link[i].right", "link[i+1].left", "ground.hook"],
    ]


def test_rows_with_other_differences_stay() -> None:
    """Masses of a taper, indices that do not follow each other, single instances and bodies with names of their own."""
    for rows in (
        [[f"link[{i}]", f"{0.05 * 2**i} kg"] for i in range(3)],
        [[f"link[{i}]", f"1.{i} kg"] for i in range(1, 4)],
        [["link[0]", "1 kg"], ["link[1]", "1.1 kg"]],
        [["link[0]", "1 kg"], ["link[2]", "1 kg"]],
        [["link[0]", "1 kg"]],
        [["rod_1", "1 kg"], ["rod_2", "1 kg"]],
        [["link[0]", "rigid"], ["link[1]", "flexible"]],
    ):
        assert merged_rows(rows) == rows
