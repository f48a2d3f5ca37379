"""Run the verification programs, fill checks.csv and make the tables and pictures of doc/verification.md.

usage: verify.py build/release
"""

import sys
from pathlib import Path

import catalogue
import document
import pictures


def main(build):
    rows, wrong, curves = catalogue.read_rows(), [], {}
    for test in catalogue.programs():
        print(test, flush=True)
        checks, points = catalogue.run(catalogue.ROOT / build / "tests/verification" / test)
        filled, unmatched = catalogue.fill(rows, checks, test)
        curves |= points
        by_name = {row["name"]: row for row in filled}
        rows = [by_name.get(row["name"], row) for row in rows]
        wrong += unmatched + [text for row in filled if (text := catalogue.verdict(row))]
    if any("no row" in text or "no test" in text for text in wrong):
        sys.exit("\n".join(wrong))
    catalogue.write_rows(rows)
    document.DOCUMENT.write_text(document.render(document.DOCUMENT.read_text(), rows))
    for path in pictures.draw(rows, curves, document.DOCUMENT.parent / "verification"):
        print(f"written: {Path(path).relative_to(catalogue.ROOT)}")
    sys.exit("\n".join(wrong) or 0)


if __name__ == "__main__":
    main(*sys.argv[1:])
