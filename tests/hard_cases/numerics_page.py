"""Put the table of docs/numerics.json on docs/numerics.md.

make numerics
"""

import json
from itertools import groupby
from pathlib import Path

from register import ELSEWHERE, NOT_HERE

DOCS = Path(__file__).resolve().parents[2] / "docs"
BEGIN = "<!-- table: written by tests/hard_cases/numerics_page.py -->\n"
END = "<!-- end of table -->"


def rows():
    """What the tests recorded."""
    return json.loads((DOCS / "numerics.json").read_text(encoding="utf-8"))


def number(x):
    """A number, short."""
    return f"{x:.6g}"


def table(records):
    """Markdown table of records, a case's name in its first row only."""
    lines = [
        "| case | what | technique | backend | expected | got | tolerance |\n",
        "|---|---|---|---|---|---|---|\n",
    ]
    for case, some in groupby(records, key=lambda row: row["case"]):
        for i, row in enumerate(some):
            cells = [
                case if i == 0 else "", row["what"], row["technique"], row["backend"],
                number(row["expected"]), number(row["got"]), number(row["tolerance"]),
            ]  # fmt: skip
            lines.append(f"| {' | '.join(cells)} |\n")
    return "".join(lines)


def register():
    """Cases that have no row of their own: where they are proven, or why they do not apply."""
    lines = [f"| {case} | `{test}` |\n" for case, test in ELSEWHERE.items()]
    lines += [f"| {case} | not here: {why} |\n" for case, why in NOT_HERE.items()]
    return "".join(["| case | proven by |\n", "|---|---|\n", *lines])


def page(text, records):
    """Text of the page with its table renewed."""
    before, rest = text.split(BEGIN)
    _, after = rest.split(END)
    return f"{before}{BEGIN}\n{table(records)}\n{register()}\n{END}{after}"


if __name__ == "__main__":
    path = DOCS / "numerics.md"
    path.write_text(page(path.read_text(encoding="utf-8"), rows()), encoding="utf-8")
    print(f"{path}: {len(rows())} rows")
