"""Tables of doc/verification.md from the rows of checks.csv: what stands between <!-- table: NAME --> and <!-- end -->."""

import re

from catalogue import ROOT, error_of

DOCUMENT = ROOT / "doc/verification.md"
PLACE = re.compile(r"(<!-- table: (\w+) -->\n).*?(<!-- end -->)", re.DOTALL)


def scaled(row, text):
    """A number of a row as the reader sees it: relative ones in per cent."""
    value = 100 * float(text) if row["metric"] == "relative" else float(text)
    return f"{value:.2g}" if value < 100 else f"{value:.0f}"


def unit(row):
    return "%" if row["metric"] == "relative" else row["unit"].replace("-", "")


def table(rows):
    """One table. Columns nothing stands in are left out: of values where all are errors, of MFIX where it has none."""
    values = any(float(row["expected"]) for row in rows)
    peers = any(row["peer"] for row in rows)
    head = ["", *(["expected", "computed"] if values else []), "error", "allowed", *(["MFIX"] if peers else []), ""]
    lines = [head, ["---"] * len(head)]
    for row in rows:
        cells = [row["quantity"]]
        if values:
            cells += [f"{float(row[key]):.6g}" for key in ("expected", "computed")]
        cells += [f"{scaled(row, error_of(row))} {unit(row)}", scaled(row, row["tolerance"])]
        if peers:
            cells.append(scaled(row, row["peer"]) if row["peer"] else "")
        lines.append([*map(str.strip, cells), "**missed**" if row["missed"] else "met"])
    return "".join("| " + " | ".join(line) + " |\n" for line in lines)


def pictures_in(text):
    return re.findall(r"!\[[^]]*\]\(([^)]*)\)", text)


def tables_in(text):
    return [match[2] for match in PLACE.finditer(text)]


def render(text, rows):
    """The document with its tables made anew."""
    return PLACE.sub(lambda match: match[1] + table([row for row in rows if row["table"] == match[2]]) + match[3], text)
