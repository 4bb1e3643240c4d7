#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Judges the conformance cases themselves: form, rules, and whether every rule and every diagnostic has one.

usage: check_cases.py
"""
import json
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent
PROJECT = ROOT.parent
SCHEMA = json.loads((ROOT / "case.schema.json").read_text(encoding="utf-8"))
TYPES = {"object": dict, "array": list, "string": str, "integer": int, "number": (int, float), "boolean": bool}
# Rules that nothing can break: they say what a document means, and other cases rest on them.
MEANING_ONLY = ("R-5.10.13", "R-5.12.5", "R-5.12.6", "R-5.6.1", "R-5.8.3", "R-5.9.5", "R-5.2.1")


def violations(value, schema, where="case"):
    """The part of JSON Schema that case.schema.json uses."""
    if "$ref" in schema:
        schema = {**SCHEMA["$defs"][schema["$ref"].rsplit("/", 1)[1]], **{k: v for k, v in schema.items() if k != "$ref"}}
    if "enum" in schema and value not in schema["enum"]:
        yield f"{where}: {value!r} is not one of {schema['enum']}"
    kind = schema.get("type")
    if kind and (not isinstance(value, TYPES[kind]) or (kind in ("integer", "number") and isinstance(value, bool))):
        yield f"{where}: not of type {kind}"
        return
    if isinstance(value, str) and not re.search(schema.get("pattern", ""), value):
        yield f"{where}: {value!r} does not match {schema['pattern']}"
    if isinstance(value, list):
        if not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)):
            yield f"{where}: {len(value)} items"
        for i, item in enumerate(value):
            yield from violations(item, schema.get("items", {}), f"{where}[{i}]")
    if isinstance(value, dict):
        known = schema.get("properties", {})
        yield from (f"{where}: {k} is missing" for k in schema.get("required", []) if k not in value)
        if "anyOf" in schema and not any(all(k in value for k in option["required"]) for option in schema["anyOf"]):
            yield f"{where}: nothing is expected"
        for key, item in value.items():
            if key in known:
                yield from violations(item, known[key], f"{where}.{key}")
            elif schema.get("additionalProperties") is False:
                yield f"{where}: unknown key {key}"


def rules_of_specification():
    text = "\n".join(p.read_text(encoding="utf-8") for p in sorted((PROJECT / "docs" / "specification").glob("*.md")))
    return set(re.findall(r"\*\*(R-\d+\.\d+(?:\.\d+)?)\b", text))


def main():
    faults, cited, codes = [], set(), set()
    specified = rules_of_specification()
    paths = sorted((ROOT / "cases").rglob("*.expect.json"))
    for path in paths:
        name = path.relative_to(ROOT / "cases")
        case = json.loads(path.read_text(encoding="utf-8"))
        faults += [f"{name}: {v}" for v in violations(case, SCHEMA)]
        errors = case.get("errors", []) + case.get("cells", {}).get("errors", [])
        rules = {case["rule"], *(e["rule"] for e in errors)}
        faults += [f"{name}: {r} is not in the specification" for r in sorted(rules - specified)]
        if name.parts[0] != case["profile"]:
            faults.append(f"{name}: is in another profile's folder")
        is_package = case["profile"] == "package"
        if not path.with_name(path.name.replace(".expect.json", ".mesoz" if is_package else ".meso")).exists():
            faults.append(f"{name}: has no document")
        if not is_package and (case.get("verdict") == "invalid") != bool(case.get("errors")):
            faults.append(f"{name}: errors and verdict do not agree")
        cited |= rules
        codes |= {e["code"] for e in errors if "code" in e}
    for document in sorted((ROOT / "cases").rglob("*.meso*")):
        if not document.with_suffix(".expect.json").exists():
            faults.append(f"{document.relative_to(ROOT / 'cases')}: expects nothing")
    chapter = sorted(r for r in specified if r.startswith("R-5."))
    faults += [f"{r}: has no case" for r in chapter if r not in cited and r not in MEANING_ONLY]
    registry = json.loads((PROJECT / "schema" / "diagnostics.json").read_text(encoding="utf-8"))
    excused = {b["block"] for b in registry["blocks"] if b.get("reason")}
    for c in registry["codes"]:
        if c["name"] not in codes and not c.get("reason") and c["number"] // 1000 not in excused:
            faults.append(f"{c['name']}: has neither a case nor a reason in schema/diagnostics.json")
        if "rule" in c and c["rule"] not in specified:
            faults.append(f"{c['name']}: {c['rule']} is not in the specification")
    for fault in faults:
        print(fault)
    print(f"{len(paths)} cases, {len(cited)} rules cited, {len(faults)} faults")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
