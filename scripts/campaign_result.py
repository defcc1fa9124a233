#!/usr/bin/env python3
"""campaign_result.py TEST COMMIT GTEST_JSON: what benchmarks/results/ keeps of a run of a statistical test."""

import json
import sys

# What GoogleTest says of every case; all else a test has recorded itself.
OWN = {"name", "file", "line", "status", "result", "timestamp", "time", "classname", "failures", "value_param",
       "type_param"}


def number(text):
    try:
        return json.loads(text)
    except ValueError:
        return text


def main():
    test, commit, path = sys.argv[1:]
    with open(path, encoding="utf-8") as file:
        run = json.load(file)
    cases = []
    for suite in run["testsuites"]:
        for case in suite["testsuite"]:
            if case["result"] != "COMPLETED":
                continue
            recorded = {key: number(value) for key, value in case.items() if key not in OWN}
            cases.append({
                "name": suite["name"] + "." + case["name"],
                "passed": "failures" not in case,
                "seconds": float(case["time"].rstrip("s")),
                **{key: recorded.pop(key) for key in ("draws", "seed") if key in recorded},
                **({"found": recorded} if recorded else {}),
            })
    result = {"schema": "idim.campaign.1", "test": test, "commit": commit, "date": run["timestamp"], "cases": cases}
    print(json.dumps(result, indent=1, ensure_ascii=False))


main()
