#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the field of the direction beam: at each record a stroke along the principal stress that is largest there. Needs numpy and matplotlib.

usage: picture.py OUT.png
"""

import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.collections import LineCollection  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent


def panel(axes, title, tensors, across, axis):
    """One middle plane: z to the right, `axis` (0 or 1, for x or y) upwards."""
    values, vectors = np.linalg.eigh(tensors)
    which = np.where(values[..., 2] > -values[..., 0], 2, 0)
    stress = np.take_along_axis(values, which[..., None], -1)[..., 0]
    direction = np.take_along_axis(vectors, which[..., None, None], -1)[..., 0]
    v, z = np.meshgrid(across, 2.5 + 5 * np.arange(40), indexing="ij")
    middle, stroke = np.stack([z, v], -1), 2.2 * direction[..., [2, axis]]
    ends = np.stack([middle - stroke, middle + stroke], -2).reshape(-1, 2, 2)
    lines = LineCollection(ends, array=stress.ravel(), cmap="coolwarm", linewidths=2.2)
    lines.set_clim(-10, 10)
    axes.add_collection(lines)
    axes.set(title=title, xlim=(0, 200), ylim=(across[0] - 2.5, across[-1] + 2.5), aspect="equal", ylabel=f"{'xy'[axis]} / mm")
    axes.set_facecolor("0.93")
    return lines


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    s = np.fromfile(HERE / "stress.raw", dtype="<f8").reshape(-1, 6)
    tensors = s[:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(-1, 3, 3)
    flanges, web = tensors[:800].reshape(10, 2, 40, 3, 3), tensors[800:].reshape(8, 40, 3, 3)
    figure, axes = plt.subplots(3, 1, figsize=(10, 7.2), sharex=True, constrained_layout=True)
    x = -22.5 + 5 * np.arange(10)
    panel(axes[0], "upper flange, y = 26 mm (force at z = 192 to 200, x = 17 to 25)", flanges[:, 1], x, 0)
    panel(axes[1], "web, x = 0", web, -17.5 + 5 * np.arange(8), 1)
    lines = panel(axes[2], "lower flange, y = -26 mm", flanges[:, 0], x, 0)
    axes[2].set_xlabel("z / mm (held at 0)")
    figure.colorbar(lines, ax=axes, label="principal stress that is largest in size / MPa", extend="both", shrink=0.7)
    figure.savefig(sys.argv[1], dpi=84, metadata={"Software": None})


if __name__ == "__main__":
    main()
