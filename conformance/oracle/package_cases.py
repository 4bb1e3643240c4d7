#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The conformance cases of packages: good ones, and one for each way to break chapter 9. Made from its text by zipfile.

usage: package_cases.py write | check      check: the cases are what this program writes
"""
import hashlib
import io
import json
import pathlib
import struct
import sys
import zipfile

FOLDER = pathlib.Path(__file__).resolve().parents[1] / "cases" / "package"
MIMETYPE = b"application/vnd.meso+zip"
DOCUMENT = b"""<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">
  <vectorFields>
    <vectorField id="f">
      <structure records="1">
        <component name="x" role="position"/>
        <component name="y" role="position"/>
        <component name="z" role="position"/>
        <points/>
      </structure>
      <external href="HREF" format="csv"/>
    </vectorField>
  </vectorFields>
</meso>
"""
TABLE = b"x,y,z\n1,2,3\n"


def document(href="data/f.csv"):
    return DOCUMENT.replace(b"HREF", href.encode())


def manifest(files):
    return b"".join(f"{hashlib.sha256(data).hexdigest()}  {name}\n".encode() for name, data in files)


def package(files, listed=None, mimetype=MIMETYPE, first_method=zipfile.ZIP_STORED, modes=None, method=zipfile.ZIP_DEFLATED):
    """mimetype, the files in their order, then the manifest of `listed` (bytes, files, or None: all of them)."""
    sums = listed if isinstance(listed, bytes) else manifest(files if listed is None else listed)
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        entries = ([("mimetype", mimetype)] if mimetype is not None else []) + list(files) + [("manifest.sha256", sums)]
        for name, data in entries:
            info = zipfile.ZipInfo(name)  # dated 1980-01-01
            info.create_system = 3
            info.external_attr = (modes or {}).get(name, 0o100644) << 16
            info.compress_type = first_method if name == "mimetype" else method
            archive.writestr(info, data)
    return out.getvalue()


def with_names(data, old, new):
    """Names of equal length replaced, in local headers and in the directory: what zipfile itself would not write."""
    assert len(old) == len(new) and data.count(old) >= 2
    return data.replace(old, new)


def with_stated_size(data, name, size):
    """The directory and the local header announce another inflated size."""
    out, at = bytearray(data), 0
    for signature, place, offset in ((b"PK\x03\x04", 30, 22), (b"PK\x01\x02", 46, 24)):
        at = 0
        while (at := data.find(signature, at)) >= 0:
            if data[at + place:at + place + len(name)] == name:
                struct.pack_into("<I", out, at + offset, size)
            at += 4
    return bytes(out)


def cases():
    """(name, rule, title, verdict, bytes)."""
    files = [("beam.meso", document()), ("data/f.csv", TABLE)]
    good = package(files)
    yield "whole", "R-9.1", "A package with a document, a file and its sums", "valid", good
    yield "stored", "R-9.2", "Entries may be stored", "valid", package(files, method=zipfile.ZIP_STORED)
    yield "other_entries", "R-9.9", "Files that the document does not name may stand there", "valid", package([*files, ("LICENCE", b"free\n")])
    yield ("shortest_form", "R-9.6", "An href means the entry of its shortest form", "valid",
           package([("beam.meso", document("./data/../data/f.csv")), files[1]]))
    yield "other_method", "R-9.2", "Entries are stored or deflated", "invalid", package(files, method=zipfile.ZIP_BZIP2)
    yield "without_mimetype", "R-9.3", "The first entry says what the file is", "invalid", package(files, mimetype=None)
    yield "other_mimetype", "R-9.3", "The first entry says that it is this format", "invalid", package(files, mimetype=b"application/zip")
    yield "packed_mimetype", "R-9.3", "The first entry is stored", "invalid", package(files, first_method=zipfile.ZIP_DEFLATED)
    yield "name_climbs", "R-9.4", "No name has a step ..", "invalid", package([*files, ("../evil.csv", TABLE)])
    yield "name_absolute", "R-9.4", "No name begins with /", "invalid", package([*files, ("/etc/evil.csv", TABLE)])
    yield "name_backslash", "R-9.4", "No name has a backslash", "invalid", with_names(package([*files, ("data|e.csv", TABLE)]), b"data|e.csv", b"data\\e.csv")
    yield "folder_entry", "R-9.4", "There are no entries for folders", "invalid", package([*files, ("data/", b"")])
    yield "name_twice", "R-9.5", "No two entries have one name", "invalid", with_names(package([*files, ("data/g.csv", TABLE)]), b"data/g.csv", b"data/f.csv")
    yield "name_twice_by_case", "R-9.5", "Nor names that differ in A-Z and a-z only", "invalid", package([*files, ("data/F.CSV", TABLE)])
    yield "name_is_a_folder", "R-9.5", "No entry is the folder of another", "invalid", package([*files, ("data", TABLE)])
    yield "link", "R-9.5", "An entry is no symbolic link", "invalid", package(files, modes={"data/f.csv": 0o120777})
    yield "two_documents", "R-9.6", "There is one document at the root", "invalid", package([*files, ("other.meso", document())])
    yield "no_document", "R-9.6", "There is a document", "invalid", package(files[1:])
    yield "href_leads_out", "R-9.6", "An href stays in the package", "invalid", package([("beam.meso", document("../f.csv")), files[1]])
    yield "href_of_nothing", "R-9.6", "An href names an entry", "invalid", package([("beam.meso", document("data/g.csv")), files[1]])
    yield "sum_differs", "R-9.7", "Every entry has the sum that the manifest states", "invalid", package(files, [files[0], ("data/f.csv", TABLE + b"4,5,6\n")])
    yield "sum_missing", "R-9.7", "Every entry has a line of the manifest", "invalid", package(files, files[:1])
    yield "sum_of_nothing", "R-9.7", "Every line of the manifest has an entry", "invalid", package(files, [*files, ("data/g.csv", TABLE)])
    yield "sum_twice", "R-9.7", "No name has two lines", "invalid", package(files, [*files, files[1]])
    yield "manifest_of_other_form", "R-9.7", "Sums are hexadecimal digits in lower case", "invalid", package(files, manifest(files).upper())
    yield "size_differs", "R-9.12", "An entry has as many bytes as are announced", "invalid", with_stated_size(good, b"data/f.csv", 5)
    yield "cut", "R-9.2", "A package is whole", "invalid", good[:-30]


def main():
    if len(sys.argv) != 2 or sys.argv[1] not in ("write", "check"):
        sys.exit(__doc__.split("\n\n")[1])
    wanted = {}
    for name, rule, title, verdict, data in cases():
        folder = rule.removeprefix("R-")
        wanted[f"{folder}/{name}.mesoz"] = data
        case = {"rule": rule, "profile": "package", "title": title, "verdict": verdict}
        wanted[f"{folder}/{name}.expect.json"] = (json.dumps(case, indent=1) + "\n").encode()
    found = {str(p.relative_to(FOLDER)): p for p in sorted(FOLDER.rglob("*")) if p.is_file()}
    if sys.argv[1] == "write":
        for name, data in wanted.items():
            (FOLDER / name).parent.mkdir(parents=True, exist_ok=True)
            (FOLDER / name).write_bytes(data)
        return
    faults = [n for n in sorted(wanted.keys() | found.keys()) if n not in found or n not in wanted]
    # Deflated bytes may differ from one zlib to another; what they hold does not.
    for name in wanted.keys() & found.keys():
        if name.endswith(".json") and found[name].read_bytes() != wanted[name]:
            faults.append(name)
    print("\n".join(f"{f}: run package_cases.py write" for f in faults) or f"{len(wanted) // 2} cases")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
