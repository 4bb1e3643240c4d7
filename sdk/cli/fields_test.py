#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fields through the command, against numpy, scipy, h5py and VTK; and what is said about bad ones.

usage: fields_test.py MESO      (tests whose package is missing are skipped)
"""
import base64
import json
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import unittest

try:
    import numpy
except ImportError:
    sys.exit(77)  # skipped
try:
    import h5py
except ImportError:
    h5py = None
try:
    import scipy.interpolate
    import scipy.spatial
except ImportError:
    scipy = None
try:
    import vtk
    from vtk.util import numpy_support
except ImportError:
    vtk = None

MESO = sys.argv.pop(1) if len(sys.argv) > 1 else "meso"
FIXTURES = pathlib.Path(__file__).resolve().parents[2] / "importers"
POSITION = "".join(f'<component name="{a}" role="position"/>' for a in "xyz")


def run(*arguments):
    done = subprocess.run([MESO, *map(str, arguments)], capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


def document(field, pattern, parameters, before=""):
    return (f'<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">\n{before}<unitCells><unitCell id="c">'
            + "".join(f'<parameter id="{p}" value="0"/>' for p in parameters)
            + f'<csg><sphere radius="1"/></csg></unitCell></unitCells>\n<vectorFields>\n{field}\n</vectorFields>\n'
            f'<patterns><pattern id="p" unitCell="c">{pattern}'
            + "".join(f'<set parameter="{p}" value="{e}"/>' for p, e in parameters.items())
            + "</pattern></patterns>\n</meso>\n")


def embedded(values):
    return "<embedded>" + base64.b64encode(numpy.ascontiguousarray(values, "<f8").tobytes()).decode() + "</embedded>"


class Case(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory()
        self.addCleanup(self._folder.cleanup)
        self.folder = pathlib.Path(self._folder.name)

    def evaluated(self, text, columns):
        """The columns of `meso eval`, one row for each cell."""
        (self.folder / "d.meso").write_text(text)
        code, _, stderr = run("eval", self.folder / "d.meso", self.folder / "d.csv")
        self.assertEqual(code, 0, stderr)
        rows = [line.split(",") for line in (self.folder / "d.csv").read_text().split("\n") if line]
        taken = [rows[0].index(c) for c in columns]
        return numpy.array([[float(row[c]) for c in taken] for row in rows[1:]])


def random_doubles(random, shape):
    """Of every size, subnormal ones and both zeros among them."""
    bits = random.integers(0, 2**64, size=shape, dtype=numpy.uint64, endpoint=False)
    values = bits.view(numpy.float64).copy()
    values[~numpy.isfinite(values)] = -0.0
    values.flat[0] = 5e-324
    return values


class RoundTrip(Case):
    """Every format to .meso and to .h5: the same eight bytes a number that another reader of the file finds."""

    def check(self, file, expected, *flags):
        out = self.folder / "out.h5"
        if h5py:
            code, _, stderr = run("field", "import", file, out, *flags)
            self.assertEqual(code, 0, stderr)
            with h5py.File(out) as h:
                self.assertEqual(h["records"][...].tobytes(), expected.tobytes(), file)
        meso = self.folder / "out.meso"
        code, _, stderr = run("field", "import", file, meso, *flags)
        self.assertEqual(code, 0, stderr)
        text = meso.read_text()
        values = base64.b64decode(re.search(r"</structure>\s*<embedded>([^<]*)", text)[1])
        width = len(values) // 8 // len(expected)
        self.assertIn(width, (expected.shape[1], expected.shape[1] - 3))  # a grid says its places otherwise
        self.assertEqual(values, expected[:, expected.shape[1] - width:].tobytes(), file)
        code, _, stderr = run("validate", meso)
        self.assertEqual(code, 0, stderr)

    def test_csv(self):
        values = random_doubles(numpy.random.default_rng(1), (50, 5))
        file = self.folder / "v.csv"
        file.write_text("x,y,z,a,b\n" + "".join(",".join(map(repr, row)) + "\n" for row in values.tolist()))
        self.check(file, values)

    @unittest.skipUnless(h5py, "python3-h5py")
    def test_hdf5(self):
        values = random_doubles(numpy.random.default_rng(2), (500, 4))
        for name, options in {"plain": {}, "packed": {"chunks": (64, 3), "compression": "gzip", "shuffle": True}}.items():
            file = self.folder / f"{name}.h5"
            with h5py.File(file, "w") as h:
                h.create_dataset("v", data=values, **options).attrs["components"] = ["x", "y", "z", "s"]
            self.check(file, values, "--data-set", "/v")

    @unittest.skipUnless(vtk, "python3-vtk9")
    def test_vtk(self):
        for file in sorted((FIXTURES / "field_vtk" / "fixtures").glob("*.vt[ku]")):
            if file.suffix == ".vtu":
                reader = vtk.vtkXMLUnstructuredGridReader()
            else:
                reader = vtk.vtkGenericDataObjectReader()
            reader.SetFileName(str(file))
            reader.Update()
            data = reader.GetOutput()
            points = numpy.array([data.GetPoint(i) for i in range(data.GetNumberOfPoints())])
            arrays = [points]
            for i in range(data.GetPointData().GetNumberOfArrays()):
                a = numpy_support.vtk_to_numpy(data.GetPointData().GetArray(i)).astype("<f8")
                arrays.append(a.reshape(len(points), -1))
            with self.subTest(file=file.name):
                self.check(file, numpy.concatenate(arrays, axis=1))

    def test_frd_and_msh(self):
        """What a person reads in the text, by its columns."""
        text = (FIXTURES / "field_frd" / "fixtures" / "cube.frd").read_text().split("\n")
        start = next(i for i, line in enumerate(text) if line.startswith(" -4  STRESS"))
        rows = [line for line in text[start:text.index(" -3", start)] if line.startswith(" -1")]
        stress = numpy.array([[float(r[13 + 12 * i:25 + 12 * i]) for i in range(6)] for r in rows])
        start = next(i for i, line in enumerate(text) if line.startswith("    2C"))
        rows = [line for line in text[start:text.index(" -3", start)] if line.startswith(" -1")]
        places = numpy.array([[float(r[13 + 12 * i:25 + 12 * i]) for i in range(3)] for r in rows])
        self.check(FIXTURES / "field_frd" / "fixtures" / "cube.frd", numpy.concatenate([places, stress], axis=1),
                   "--data-set", "STRESS")
        folder = FIXTURES / "field_msh" / "fixtures"
        lines = (folder / "box22.msh").read_text().split("\n")
        at = lines.index("$Nodes")
        nodes = [line.split() for line in lines[at + 2:at + 2 + int(lines[at + 1])]]
        at = lines.index("$NodeData")
        name = lines[at + 2].strip('"')
        at += 3 + int(lines[at + 1]) - 1 + 1 + int(lines[at + 3])
        tags = int(lines[at])
        count = int(lines[at + 3])
        value = {line.split()[0]: [float(v) for v in line.split()[1:]] for line in lines[at + 1 + tags:at + 1 + tags + count]}
        expected = numpy.array([[float(v) for v in n[1:]] + value[n[0]] for n in nodes])
        self.check(folder / "box22.msh", expected, "--data-set", name)

    def test_info(self):
        file = self.folder / "v.csv"
        file.write_text("x [mm],y [mm],z [mm],s [MPa]\n0,1,2,5\n3,4,9,nan\n-1,2,2,-inf\n")
        code, stdout, _ = run("field", "info", file, "--json")
        self.assertEqual(code, 0)
        told = json.loads(stdout)
        self.assertEqual(told["records"], 3)
        self.assertEqual(told["box"], {"min": [-1, 1, 2], "max": [3, 4, 9]})
        s = told["columns"][3]
        self.assertEqual([s[k] for k in ("unit", "min", "max", "nan", "infinite")], ["MPa", 5, 5, 1, 1])


class Principal(Case):
    ORDERS = ("xx", "yy", "zz", "xy", "yz", "zx")

    def principal(self, tensors):
        (self.folder / "t.raw").write_bytes(numpy.concatenate(
            [numpy.zeros((len(tensors), 3)), tensors], axis=1).astype("<f8").tobytes())
        components = POSITION + "".join(f'<component name="s{o}" role="tensor" order="{o}"/>' for o in self.ORDERS)
        field = (f'<vectorField id="f"><structure records="{len(tensors)}">{components}<points/></structure>'
                 '<external href="t.raw" format="raw"/></vectorField>')
        names = {f"v{i}": f"f.principal{i}" for i in (1, 2, 3)} | {
            f"d{i}{a}": f"f.dir{i}{a}" for i in (1, 2, 3) for a in "xyz"}
        table = self.evaluated(document(field, '<scatter field="f"/>', names), names)
        return table[:, :3], table[:, 3:].reshape(-1, 3, 3)

    @staticmethod
    def matrices(tensors):
        m = numpy.empty((len(tensors), 3, 3))
        for i, o in enumerate(Principal.ORDERS):
            r, c = "xyz".index(o[0]), "xyz".index(o[1])
            m[:, r, c] = m[:, c, r] = tensors[:, i]
        return m

    def test_axes_agree_with_eigh(self):
        random = numpy.random.default_rng(3)
        count = 10_000
        turn, _ = numpy.linalg.qr(random.normal(size=(count, 3, 3)))
        values = random.uniform(-1, 1, size=(count, 3))
        values[::4, 1] = values[::4, 0] * (1 + 10 ** random.uniform(-3, -1, size=count // 4))  # nearly equal
        values *= 10 ** random.uniform(-6, 6, size=(count, 1))
        m = turn @ (values[:, :, None] * turn.transpose(0, 2, 1))
        tensors = numpy.stack([m[:, "xyz".index(o[0]), "xyz".index(o[1])] for o in self.ORDERS], axis=1)
        m = self.matrices(tensors)
        ours, axes = self.principal(tensors)
        theirs, vectors = numpy.linalg.eigh(m)
        theirs, vectors = theirs[:, ::-1], vectors.transpose(0, 2, 1)[:, ::-1]
        size = numpy.abs(theirs).max(axis=1, keepdims=True)
        self.assertLess((numpy.abs(ours - theirs) / size).max(), 1e-14 * 10)
        gap = numpy.abs(theirs[:, :, None] - theirs[:, None, :]) / size[:, :, None] + numpy.eye(3) * 9
        apart = gap.min(axis=2) >= 1e-3
        angle = numpy.linalg.norm(numpy.cross(axes, vectors), axis=2)
        self.assertGreater(apart.sum(), 25_000)
        self.assertLess(angle[apart].max(), 1e-9)

    def test_equal_values_and_zero(self):
        """Any right axes are: orthonormal, turned into themselves, the same for the same tensor, the last part positive."""
        random = numpy.random.default_rng(4)
        turn, _ = numpy.linalg.qr(random.normal(size=(200, 3, 3)))
        values = numpy.tile([[2.0, 2.0, -1.0], [3.0, -4.0, -4.0], [5.0, 5.0, 5.0], [0.0, 0.0, 0.0]], (50, 1))
        m = turn @ (values[:, :, None] * turn.transpose(0, 2, 1))
        tensors = numpy.stack([m[:, "xyz".index(o[0]), "xyz".index(o[1])] for o in self.ORDERS], axis=1)
        ours, axes = self.principal(tensors)
        m = self.matrices(tensors)
        self.assertLess(numpy.abs(ours - numpy.sort(values)[:, ::-1]).max(), 1e-13)
        self.assertLess(numpy.abs(axes @ axes.transpose(0, 2, 1) - numpy.eye(3)).max(), 1e-14)
        self.assertLess(numpy.abs(m @ axes.transpose(0, 2, 1) - (ours[:, :, None] * axes).transpose(0, 2, 1)).max(), 1e-13)
        last = numpy.take_along_axis(axes, 2 - (axes[:, :, ::-1] != 0).argmax(axis=2)[:, :, None], axis=2)
        self.assertGreater(last.min(), 0)
        _, again = self.principal(tensors)
        self.assertTrue((again == axes).all())

    def test_answers_for_no_direction(self):
        """R-5.10.8: what `zero` says where a vector has no length."""
        components = POSITION + "".join(f'<component name="{n}" role="vector"/>' for n in ("u", "v", "w"))
        values = [[0, 0, 0, 0, 0, 0], [5, 0, 0, 1, 0, 0]]
        field = (f'<vectorField id="f"><structure records="2">{components}<points/></structure>{embedded(values)}'
                 "</vectorField>")
        text = document(field, '<scatter field="f"/><orient axis="z" x="f.u" y="f.v" z="f.w" {}/>', {"m": "f.magnitude"})
        kept = self.evaluated(text.replace("{}", 'zero="keep"'), ("m11", "m22", "m33", "m"))
        self.assertEqual(kept[0].tolist(), [1, 1, 1, 0])
        self.assertEqual(kept[1][3], 1)
        (self.folder / "e.meso").write_text(text.replace("{}", ""))
        code, _, stderr = run("eval", self.folder / "e.meso", self.folder / "e.csv")
        self.assertEqual((code, (self.folder / "e.csv").exists()), (1, False), stderr)
        self.assertEqual(stderr.count(": error "), 1, stderr)


@unittest.skipUnless(scipy and h5py, "python3-scipy and python3-h5py")
class Sampled(Case):
    """1,000 random cells beside numpy and scipy reading the same HDF5 file, to 1e-12 of the largest value."""

    def sampled(self, structure, method, points, more=""):
        field = (f'<vectorField id="f">{structure}<external href="v.h5" format="hdf5" path="/v"/>'
                 f'<interpolation method="{method}"/>{more}</vectorField>')
        places = "".join(f'<place at="{x!r}, {y!r}, {z!r}"/>' for x, y, z in points.tolist())
        return self.evaluated(document(field, f'<list>{places}</list><sample field="f"/>', {"s": "f.s"}), ("s",))[:, 0]

    def write(self, values, **options):
        with h5py.File(self.folder / "v.h5", "w") as h:
            h.create_dataset("v", data=values, compression="gzip", shuffle=True, **options)
        with h5py.File(self.folder / "v.h5") as h:
            return h["v"][...]

    def expect(self, found, expected):
        self.assertEqual(len(found), len(expected))
        self.assertLess(numpy.abs(found - expected).max(), 1e-12 * numpy.abs(expected).max())

    def test_clouds(self):
        random = numpy.random.default_rng(5)
        values = self.write(random.uniform(-50, 50, size=(3000, 4)))
        points = random.uniform(-49, 49, size=(1000, 3))
        structure = f'<structure records="3000">{POSITION}<component name="s"/><points/></structure>'
        tree = scipy.spatial.cKDTree(values[:, :3])
        self.expect(self.sampled(structure, "nearest", points), values[tree.query(points)[1], 3])
        d, i = tree.query(points, k=8)
        w = d ** -2.0
        self.expect(self.sampled(structure, "inverseDistance", points), (w * values[i, 3]).sum(axis=1) / w.sum(axis=1))
        # At the records every method has the records' own values, to the last bit.
        for method in ("nearest", "inverseDistance"):
            self.assertTrue((self.sampled(structure, method, values[:500, :3]) == values[:500, 3]).all())

    def test_grid(self):
        random = numpy.random.default_rng(6)
        axes = [numpy.sort(random.uniform(-10, 10, size=n)) for n in (9, 12, 7)]
        values = self.write(random.uniform(-1, 1, size=(9 * 12 * 7, 1)))
        points = numpy.stack([random.uniform(a[0], a[-1], size=1000) for a in axes], axis=1)
        at = "".join(f'<axis name="{n}" at="{", ".join(map(repr, a.tolist()))}"/>' for n, a in zip("xyz", axes))
        structure = f'<structure records="756"><component name="s"/><rectilinearGrid>{at}</rectilinearGrid></structure>'
        grid = scipy.interpolate.RegularGridInterpolator(axes, values.reshape(9, 12, 7))
        self.expect(self.sampled(structure, "linear", points), grid(points))
        nodes = numpy.stack(numpy.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        self.assertTrue((self.sampled(structure, "linear", nodes) == values[:, 0]).all())

    def test_tetrahedra(self):
        random = numpy.random.default_rng(7)
        places = random.uniform(-1, 1, size=(400, 3))
        mesh = scipy.spatial.Delaunay(places)
        values = self.write(numpy.concatenate([places, random.uniform(-1, 1, size=(400, 1))], axis=1))
        points = random.uniform(-0.6, 0.6, size=(1000, 3))
        corners = base64.b64encode(mesh.simplices.astype("<i8").tobytes()).decode()
        structure = (f'<structure records="400">{POSITION}<component name="s"/><mesh type="tetra" '
                     f'elements="{len(mesh.simplices)}"><embedded>{corners}</embedded></mesh></structure>')
        simplex = mesh.find_simplex(points)
        self.assertTrue((simplex >= 0).all())
        t = mesh.transform[simplex]
        b = numpy.einsum("nij,nj->ni", t[:, :3], points - t[:, 3])
        b = numpy.concatenate([b, 1 - b.sum(axis=1, keepdims=True)], axis=1)
        expected = (b * values[mesh.simplices[simplex], 3]).sum(axis=1)
        found = self.sampled(structure, "linear", points)
        flat = numpy.abs(numpy.linalg.det(t[:, :3])) > 1e5  # thin elements round in both
        self.assertLess(flat.sum(), 50)
        self.expect(found[~flat], expected[~flat])
        self.assertTrue((self.sampled(structure, "linear", values[:, :3]) == values[:, 3]).all())


class BadInput(Case):
    """One diagnostic each, at its place; no file is written."""

    def fault(self, field, code, where, pattern='<scatter field="f"/>', expression="f.s"):
        text = document(field, pattern, {"a": expression})
        file = self.folder / "bad.meso"
        file.write_text(text)
        out = self.folder / "out.csv"
        status, stdout, stderr = run("eval", file, out)
        lines = [line for line in stderr.split("\n") if re.search(r": (error|warning) |^error ", line)]
        self.assertEqual(len(lines), 1, stderr)
        self.assertIn(f" {code}", lines[0])
        self.assertNotEqual(status, 0)
        self.assertFalse(out.exists())
        if "|" in where:  # the text around the place in the document
            before, behind = where.split("|")
            self.assertEqual(text.count(before + behind), 1, where)
            at = text.index(before + behind) + len(before)
            where = f"bad.meso:{text.count(chr(10), 0, at) + 1}:{at - text.rfind(chr(10), 0, at)}:"
        self.assertIn("/" + where, lines[0])

    def points(self, values, records=2, unit="", components='<component name="s"/>'):
        return (f'<vectorField id="f">\n<structure records="{records}">{POSITION}{components}<points/></structure>\n'
                f"{values}</vectorField>")

    def external(self, name, content, format="csv", records=2, more="", components='<component name="s"/>'):
        mode = {"data": content} if isinstance(content, bytes) else {"data": content.encode()}
        (self.folder / name).write_bytes(mode["data"])
        return self.points(f'<external href="{name}" format="{format}"{more}/>', records, components=components)

    def test_embedded(self):
        good = embedded([[0, 0, 0, 1], [1, 0, 0, 2]])
        self.fault(self.points(good.replace("</", "A</")), "FIELD_BASE64", "|<embedded>")
        self.fault(self.points(good.replace("AAAAAAAAAAA", "AAAAA*AAAAA", 1)), "FIELD_BASE64", "|<embedded>")
        short = base64.b64encode(bytes(63)).decode()
        self.fault(self.points(f"<embedded>{short}</embedded>"), "FIELD_VALUES_SIZE", "|<embedded>")
        self.fault(self.points(good, records=3), "FIELD_VALUES_SIZE", "|<embedded>")
        self.fault(self.points(embedded([[0, 0, 0, 1], [1, 0, 0, float("nan")]])), "FIELD_NOT_FINITE", "|<embedded>")
        self.fault(self.points(embedded([[0, 0, 0, 1], [float("inf"), 0, 0, 2]])), "FIELD_NOT_FINITE", "|<embedded>")
        self.fault(self.points(good), "EXPRESSION_UNKNOWN_NAME", 'value="|f.t"', expression="f.t")

    def test_tables(self):
        self.fault(self.external("v.csv", "x,y,z,s\n0,0,0,1\n1,0,oops,2\n"), "FIELD_FILE_SYNTAX", "v.csv:3:5:")
        self.fault(self.external("v.csv", "x,y,z,s\n0,0,0,1\n"), "FIELD_RECORD_COUNT", 'records="|2"')
        self.fault(self.external("v.csv", "x,y,z,t\n0,0,0,1\n0,0,1,1\n"), "FIELD_COLUMN", 'component name="|s"')
        self.fault(self.external("v.csv", "x,y,z,s [MPa]\n0,0,0,1\n0,0,1,1\n",
                                 components='<component name="s" unit="kPa"/>'), "FIELD_UNIT", 'unit="|kPa"')
        self.fault(self.external("v.csv", "x,y,z,s\n0,0,0,nan\n0,0,1,1\n"), "FIELD_NOT_FINITE", '|<external')

    def test_files(self):
        self.fault(self.external("v.raw", bytes(63), "raw"), "FIELD_FILE_TRUNCATED", "v.raw:")
        self.fault(self.external("v.h5", b"x,y,z,s\n1,2,3,4\n", "hdf5", more=' path="/v"'), "IMPORT_UNREADABLE", 'href="|v.h5"')
        whole = (FIXTURES / "field_hdf5" / "fixtures" / "layouts.h5").read_bytes()
        self.fault(self.external("v.h5", whole[:9000], "hdf5", more=' path="/named"'), "IMPORT_UNREADABLE", 'href="|v.h5"')
        elsewhere = FIXTURES / "field_hdf5" / "fixtures" / "elsewhere.h5"
        if elsewhere.exists():
            (self.folder / "layouts.h5").write_bytes(whole)
            file = self.external("e.h5", elsewhere.read_bytes(), "hdf5", more=' path="/external_link"', records=100,
                                 components="")
            self.fault(file, "FIELD_FILE_UNSUPPORTED", "e.h5:", expression="1")

    def test_more_than_two_gibibytes(self):
        """Sizes beyond 32 bits: the last record of a sparse file is found, one more is told."""
        name, rows = "big.raw", 3
        stride = 2**30 + 32
        with open(self.folder / name, "wb") as out:
            out.truncate(2 * stride + 32)
            out.seek(2 * stride)
            out.write(struct.pack("<4d", 7, 8, 9, 10))
        field = self.points(f'<external href="{name}" format="raw" stride="{stride}"/>', rows)
        found = self.evaluated(document(field, '<scatter field="f"/>', {"a": "f.s"}), ("m14", "a"))
        self.assertEqual(found[2].tolist(), [7, 10])
        (self.folder / "d.csv").unlink()
        field = self.points(f'<external href="{name}" format="raw" stride="{stride}"/>', rows + 1)
        (self.folder / "d.meso").write_text(document(field, '<scatter field="f"/>', {"a": "f.s"}))
        code, _, stderr = run("eval", self.folder / "d.meso", self.folder / "d.csv")
        self.assertEqual((code, (self.folder / "d.csv").exists()), (3, False))
        self.assertIn(" error FIELD_FILE_TRUNCATED: the file ends after 2147483744 of 3221225600 bytes", stderr)


if __name__ == "__main__":
    unittest.main()
